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
Lockstep for a node under test: it tells when it has nothing more to do at a time.

Outside of a test nobody listens, and :func:`spin` does what ``rclpy.spin`` does.
"""

from typing import Any, List, Optional, Sequence

from rclpy.clock import JumpThreshold
from rclpy.duration import Duration
from rclpy.executors import (
    ExternalShutdownException, SingleThreadedExecutor, TimeoutException, TimeoutObject)
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Header

__all__ = ['IDLE_QOS', 'IDLE_TOPIC', 'spin']

IDLE_TOPIC = '/diffdrive_lockstep'
IDLE_QOS = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""Who comes to listen late has the last acknowledgement."""

ANY_JUMP = JumpThreshold(
    min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))


def spin(node: Node) -> None:
    """
    Spin a node, and acknowledge each time of ``/clock`` once there is nothing left to do.

    Parameters
    ----------
    node : rclpy.node.Node
        The node; it has its publishers, subscriptions and timers already, and ``use_sim_time``.

    """
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    publisher = node.create_publisher(Header, IDLE_TOPIC, IDLE_QOS)
    clock, patience = node.get_clock(), _Patience()
    times: List[Any] = [clock.now()]  # not acknowledged yet
    jumps = clock.create_jump_callback(
        ANY_JUMP, post_callback=lambda _: times.append(clock.now()))
    try:
        while node.context.ok():
            _work_off(executor, patience, times)
            publisher.publish(Header(stamp=times[-1].to_msg(), frame_id=_described(node)))
            times.clear()
    except (ExternalShutdownException, KeyboardInterrupt):
        pass
    finally:
        jumps.unregister()
        executor.shutdown()


class _Patience(TimeoutObject):
    """
    A timeout that can be changed: with another argument an executor forgets what is ready.

    The executor asks for it once each time that it looks for what is ready.
    """

    def __init__(self) -> None:
        self.seconds: Optional[float] = None
        self.looks = 0

    @property
    def timeout(self) -> Optional[float]:
        self.looks += 1
        return self.seconds


def _work_off(
        executor: SingleThreadedExecutor, patience: _Patience, times: Sequence[Any]) -> None:
    """
    Do what there is to do, in the order of ``rclpy.spin``, until a time can be acknowledged.

    While there is none, nobody asks whether there is nothing left.
    """
    looks = patience.looks
    while True:
        patience.seconds = 0.0 if times else None
        try:
            handler, _, _ = executor.wait_for_ready_callbacks(timeout_sec=patience)
        except TimeoutException:
            if patience.looks > looks:
                return
            continue  # what was done may have made more to do: look once more
        handler()
        if handler.exception() is not None:
            raise handler.exception()
        looks = patience.looks


def _described(node: Node) -> str:
    """Return the name of a node, the topics to which it listens, and those that it publishes."""
    topics = (','.join(each.topic_name for each in ends)
              for ends in (node.subscriptions, node.publishers))
    return f"{node.get_fully_qualified_name()} {' '.join(topics)}"
