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
Files and pictures: recordings, calibration files and reports, tables and drawings.

Read what is written first: ``output_files``, and what is kept of a drive in ``keeping`` (a table,
a bag, a picture, runs around a square, of what ``robots`` tells).  Then what is read:
``recordings`` (CSV) and ``bags``, of which ``recording_sources`` takes what a file needs;
``calibration`` makes a result of it, ``calibration_file`` and ``calibration_drawing`` write that.
The page and the keys by which a robot is driven stand apart.
"""
