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
What a node lives in: base class, clocks, timers, executors, diagnostics, an end.

Read ``node`` (the base class and its parts) first, then ``runtime`` (all that a node asks of the
world, answered by rclpy) and ``runtimes`` (answered on stepped time and in the lean loop), for
which ``clocks`` has the timers; ``running`` is how an executable runs and ends, ``sim_clock`` how
stepped time goes on.  ``diagnostics``, ``rejections`` and ``node_time`` are parts of every node.
"""
