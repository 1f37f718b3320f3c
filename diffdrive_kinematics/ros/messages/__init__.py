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
Messages of ROS from and to values of the core: as objects, as bytes, as URDF.

``plain`` is the codec to read, with a class or function for each message; ``serialised`` (and
``serialised_joints``) says the same in bytes, by ``cdr``; ``codec`` decides which one the nodes
use.  Then how wheel motion is read: ``wheel_joints`` (names and signs), ``wheel_messages`` (one
JointState), ``wheel_gathering`` (several publishers, messages and wheels).
"""
