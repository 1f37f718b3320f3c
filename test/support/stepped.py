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

"""What tests of several nodes on stepped time share: which nodes, and what they have said."""


def nodes(*names, **parameters):
    """Return a composition for the fixture ``diffdrive``, with parameters of nodes by name."""
    return {'/**/diffdrive_sim': {'nodes': list(names)},
            **{f'/**/{name}': values for name, values in parameters.items()}}


def messages(robot, topic):
    """Return all messages of a topic so far."""
    return [each.message for each in robot.history(topic)]
