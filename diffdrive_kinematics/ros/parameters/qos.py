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
"""
Quality of service of the topics: the package's defaults, and what the YAML puts in their place.

A topic is reliable, with a queue of 10 where the node does not ask for another.  Parameters
``qos_overrides.TOPIC.publisher.POLICY`` and ``qos_overrides.TOPIC.subscription.POLICY`` override
that, as in every ROS 2 node; TOPIC is the fully resolved name.  They are judged before anything
is created.
"""

from typing import Any, Callable, Dict, Mapping, NamedTuple, Tuple

from rclpy.duration import Infinite
from rclpy.qos import (
    DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSPolicyKind, QoSProfile,
    ReliabilityPolicy)
from rclpy.qos_overriding_options import QoSOverridingOptions

PREFIX = 'qos_overrides.'
ENDS = ('publisher', 'subscription')
MOST_DEPTH = 1_000_000
MOST_NS = Infinite.nanoseconds


class Override(NamedTuple):
    """An override: the topic, which end of it, the policy, and its value."""

    topic: str
    end: str
    policy: str
    value: Any

    def named(self) -> str:
        """Return the override as it stands in the YAML, with its value."""
        return f'{PREFIX}{self.topic}.{self.end}.{self.policy} is {self.value!r}'


def _one_of(policies: Any) -> Tuple[Callable[[Any], bool], str]:
    keys = [key for key in policies.short_keys() if key != 'unknown']
    return lambda value: value in keys, f"one of {', '.join(keys)}"


def _integer(most: int, least: int, unit: str) -> Tuple[Callable[[Any], bool], str]:
    return (lambda value: type(value) is int and least <= value <= most,
            f'an integer{unit} from {least} to {most}')


_DURATION = _integer(MOST_NS, 0, ' of nanoseconds')
POLICIES: Mapping[str, Tuple[Callable[[Any], bool], str]] = {
    'reliability': _one_of(ReliabilityPolicy), 'durability': _one_of(DurabilityPolicy),
    'history': _one_of(HistoryPolicy), 'depth': _integer(MOST_DEPTH, 1, ''),
    'deadline': _DURATION, 'lifespan': _DURATION, 'liveliness': _one_of(LivelinessPolicy),
    'liveliness_lease_duration': _DURATION}
_STRONGER = ('durability', 'deadline')  # of a publisher: none of them can lose a message


def reliable(depth: int) -> QoSProfile:
    """Return the package's default: reliable, the last ``depth`` messages."""
    return QoSProfile(depth=depth)


def latched() -> QoSProfile:
    """Return the profile of a topic whose last message is for those who come later."""
    return QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def best_effort(depth: int = 1) -> QoSProfile:
    """Return the profile of a subscription that hears publishers of any kind."""
    return QoSProfile(depth=depth, reliability=ReliabilityPolicy.BEST_EFFORT)


def overrides_from(parameters: Mapping[str, Any]) -> Dict[Tuple[str, str], Tuple[Override, ...]]:
    """
    Return the overrides among parameter values, by topic and end.

    Raises
    ------
    ValueError
        If one names no topic, end or policy, or has a value that the policy does not; every such
        override is named.

    """
    found: Dict[Tuple[str, str], Tuple[Override, ...]] = {}
    problems = []
    for name, value in parameters.items():
        if not name.startswith(PREFIX):
            continue
        topic, end, policy = _parts(name)
        if not topic.startswith('/') or end not in ENDS or policy not in POLICIES:
            problems.append(
                f'{name} is not an override, expected {PREFIX}/TOPIC.END.POLICY with the resolved '
                f"name of a topic, END {' or '.join(ENDS)} and POLICY one of "
                f"{', '.join(POLICIES)}")
        elif end == 'subscription' and policy == 'lifespan':
            problems.append(f'{name} is not an override, expected lifespan for a publisher only')
        else:
            override = Override(topic, end, policy, value)
            accepts, expected = POLICIES[policy]
            if accepts(value):
                found[topic, end] = (*found.get((topic, end), ()), override)
            else:
                problems.append(f'{override.named()}, expected {expected}')
    if problems:
        raise ValueError('; '.join(problems))
    return found


def _parts(name: str) -> Tuple[str, str, str]:
    """Return topic, end and policy of a parameter's name; empty where there are none."""
    rest, _, policy = name[len(PREFIX):].rpartition('.')
    topic, _, end = rest.rpartition('.')
    return topic, end, policy


def overriding_options(overrides: Tuple[Override, ...]) -> QoSOverridingOptions:
    """Return what makes rclpy declare and apply overrides."""
    return QoSOverridingOptions([QoSPolicyKind[each.policy.upper()] for each in overrides])


def check_delivery(overrides: Tuple[Override, ...], depth: int) -> None:
    """
    Raise ``ValueError`` for an override under which a message might not arrive.

    Parameters
    ----------
    overrides : sequence of Override
        Of one end of a topic.
    depth : int
        Depth that is sure to hold all messages that can be on their way.

    """
    safe = {'reliability': ('reliable',), 'history': ('keep_last', 'keep_all')}
    for override in overrides:
        if override.value in safe.get(override.policy, ()) or (
                override.policy == 'depth' and override.value >= depth) or (
                override.policy in _STRONGER and override.end == 'publisher'):
            continue
        raise ValueError(
            f'{override.named()}, expected none while the time is stepped (clock_step): each '
            'message has to arrive before the time goes on')
