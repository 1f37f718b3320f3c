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

"""What tests of nodes on stepped time share: which nodes, what they hear, and what they said."""

from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError
import pytest
from support.graph import wheel_motion

__all__ = ['last', 'messages', 'nodes', 'refusal', 'tell_wheels', 'time_ns']


def nodes(*names, **parameters):
    """Return a composition for the fixture ``diffdrive``, with parameters of nodes by name."""
    return {'/**/diffdrive_sim': {'nodes': list(names)},
            **{f'/**/{name}': values for name, values in parameters.items()}}


def refusal(diffdrive, node, params):
    """Return the words with which a node refuses to start, for which its process ends with 2."""
    with pytest.raises(ConfigurationError) as refused:
        diffdrive(nodes(node), params=params)
    return str(refused.value)


def messages(robot, topic):
    """Return all messages of a topic so far."""
    return [each.message for each in robot.history(topic)]


def last(robot, topic):
    """Return the last message of a topic."""
    return robot.history(topic)[-1].message


def time_ns(robot):
    """Return the simulated time [ns]."""
    return round(robot.time * 1e9)


def tell_wheels(robot, *motion, topic='wheel_rates', at_ns=None, **options):
    """Say what the wheels do, at this time or with another stamp."""
    robot.publish(topic, wheel_motion(
        time_ns(robot) if at_ns is None else at_ns, *motion, **options))
