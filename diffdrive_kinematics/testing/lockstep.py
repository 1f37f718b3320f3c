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

from rclpy.executors import (
    ExternalShutdownException, SingleThreadedExecutor, TimeoutException, TimeoutObject)
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Header

__all__ = ['IDLE_TOPIC', 'spin']

IDLE_TOPIC = '/diffdrive_lockstep'
CLOCK_QOS = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
WAIT_S = 0.1


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
    publisher = node.create_publisher(Header, IDLE_TOPIC, 10)
    times, patience = [], _Patience()
    node.create_subscription(Clock, '/clock', lambda message: times.append(message.clock),
                             CLOCK_QOS)
    try:
        while node.context.ok():
            _work_off(executor, patience)
            now_ns = node.get_clock().now().nanoseconds
            if times and Time.from_msg(times[-1]).nanoseconds == now_ns:
                publisher.publish(Header(stamp=times[-1], frame_id=_described(node)))
                times.clear()
    except (ExternalShutdownException, KeyboardInterrupt):
        pass
    finally:
        executor.shutdown()


class _Patience(TimeoutObject):
    """
    A timeout that can be changed: with another argument an executor forgets what is ready.

    The executor asks for it once each time that it looks for what is ready.
    """

    def __init__(self) -> None:
        self.seconds, self.looks = 0.0, 0

    @property
    def timeout(self) -> float:
        self.looks += 1
        return self.seconds


def _work_off(executor: SingleThreadedExecutor, patience: _Patience) -> None:
    """Wait for something to do, and do all that there is, in the order of ``rclpy.spin``."""
    patience.seconds, looks = WAIT_S, 0
    while True:
        try:
            handler, _, _ = executor.wait_for_ready_callbacks(timeout_sec=patience)
        except TimeoutException:
            if patience.looks > looks:
                return
            continue  # what was done may have made more to do: look once more
        handler()
        if handler.exception() is not None:
            raise handler.exception()
        patience.seconds, looks = 0.0, patience.looks


def _described(node: Node) -> str:
    """Return the name of a node, and how many topics it listens to and publishes."""
    topics = [len({each.topic_name for each in ends})
              for ends in (node.subscriptions, node.publishers)]
    return f'{node.get_namespace()} {node.get_name()} {topics[0]} {topics[1]}'
