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
What comes in and is believed: commands, emergency stop, drivers and their clocks.

Commands: ``command_intake``, ``emergency_stop``.  Wheel motion: ``wheel_watch`` (its publishers
and single wheels), ``driver_watch`` (its units and clock).  Of any topic: ``publisher_watch`` (who
publishes), ``other_clock`` (whose stamps).  What is asked of other nodes: ``other_nodes``.
"""
