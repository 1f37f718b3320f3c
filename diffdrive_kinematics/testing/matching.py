# Copyright 2026 diffdrive_kinematics contributors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Whether publishers and subscriptions have found all in the graph that they can talk to."""

from rclpy.duration import Duration, Infinite
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, qos_check_compatible, QoSCompatibility, QoSProfile
from rclpy.subscription import Subscription

__all__ = ['has_publishers', 'has_subscribers', 'is_latched']


def has_subscribers(publisher: Publisher, observer: Node) -> bool:
    """Return whether a publisher has found all who can hear it, by their quality of service."""
    found, topic = publisher.get_subscription_count(), publisher.topic_name
    return found >= observer.count_subscribers(topic) or found >= sum(
        _fit(publisher.qos_profile, each.qos_profile)
        for each in observer.get_subscriptions_info_by_topic(topic))


def has_publishers(subscription: Subscription, observer: Node) -> bool:
    """Return whether a subscription has found all whom it can hear."""
    found, topic = subscription.get_publisher_count(), subscription.topic_name
    return found >= observer.count_publishers(topic) or found >= sum(
        _fit(each.qos_profile, subscription.qos_profile)
        for each in observer.get_publishers_info_by_topic(topic))


def is_latched(topic: str, observer: Node) -> bool:
    """Return whether somebody listens to a topic who asks for what was said before, too."""
    return any(each.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
               for each in observer.get_subscriptions_info_by_topic(topic))


def _fit(publisher: QoSProfile, subscription: QoSProfile) -> bool:
    compatible, _ = qos_check_compatible(_told(publisher), _told(subscription))
    return bool(compatible != QoSCompatibility.ERROR)


def _told(profile: QoSProfile) -> QoSProfile:
    """Return a profile as the graph tells it: what is not said, which is 0, is infinite there."""
    return QoSProfile(
        depth=1, reliability=profile.reliability, durability=profile.durability,
        liveliness=profile.liveliness, deadline=_limit(profile.deadline),
        liveliness_lease_duration=_limit(profile.liveliness_lease_duration))


def _limit(duration: Duration) -> Duration:
    return duration if duration.nanoseconds else Infinite
