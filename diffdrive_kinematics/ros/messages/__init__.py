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

Commands are objects, of which some tens a second are sent (``twists``); what base, noise and
controller say at every tick, and messages of many poses, are bytes (``serialised``,
``serialised_joints``), by ``cdr``.  ``messages`` has stamps and poses.  Then how wheel motion is
read: ``wheel_joints`` (names and signs), ``wheel_messages`` (one JointState),
``wheel_gathering`` (several publishers, messages and wheels).
"""
