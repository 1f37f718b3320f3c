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

"""The pytest plugin: the fixture ``diffdrive``, where rclpy is."""

from importlib.util import find_spec

import pytest

if find_spec('rclpy'):
    @pytest.fixture
    def diffdrive():
        """
        Return what makes simulated robots; they are gone after the test, whatever happens.

        Each has a domain of its own.  The arguments are those of
        ``diffdrive_kinematics.testing.Robot``.
        """
        from diffdrive_kinematics.testing.robot import Robot
        robots = []

        def make(*arguments, **options):
            robots.append(Robot(*arguments, **options))
            return robots[-1]

        try:
            yield make
            for robot in robots:
                robot.check()
        finally:
            for robot in reversed(robots):
                robot.close()
