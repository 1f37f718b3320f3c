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

"""What a node tells about its health on /diagnostics, as a test hears it."""

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR


def collect(graph, name):
    """Return a list to which each status of a node is added, as (level, message, values)."""
    statuses = []

    def handle(message):
        statuses.extend(
            (status.level, status.message, {pair.key: pair.value for pair in status.values})
            for status in message.status if status.name == name)

    graph.collect(DiagnosticArray, '/diagnostics', handle)
    return statuses


def wait_for_level(graph, statuses, level, words=''):
    """Return the latest status of a level with some words in its message, once it is there."""
    return graph.wait_for(
        lambda: next((status for status in reversed(statuses)
                      if status[0] == level and words in status[1]), None),
        f'level {level} with {words!r} in {statuses[-1:]}')


def statuses_of(robot, name):
    """Return each status of a node of the fixture ``diffdrive``, once it listens to them."""
    return [(status.level, status.message, {pair.key: pair.value for pair in status.values})
            for each in robot.history('/diagnostics') for status in each.message.status
            if status.name == name]


def with_health(robot):
    """Return a robot whose diagnostics are kept."""
    robot.listen(DiagnosticArray, '/diagnostics')
    return robot
