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
The mathematics of the package: pure functions and frozen values, no ROS, no YAML, no files.

Conventions, stated once for all modules:

* SI units and radians; stamps are integers of nanoseconds.
* Axes as in REP-103: x forward, y left, theta counter-clockwise; wheel rates positive = forward.
* Pairs of wheels are (left, right); twists are (v, w); poses are (x, y, theta).
* theta is wrapped to (-pi, pi] where it is reported, and unwrapped in between.
* ``x_from_y`` converts y to x.  Functions return new values and write into no argument.
* Bad values raise ``ValueError`` with the name, the value and what was expected.

Equation numbers without a source are those of LaValle, "Mobile Robotics" (ch. 2 of the notes
"Mobile Robotics: An Information Space Approach"); other sources are named where they are used.
"""
