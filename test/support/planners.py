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

"""The planner that the tutorial shows, others like it, and the robot that they drive."""

from pathlib import Path
import re

PAGE = Path(__file__).resolve().parents[2] / 'docs' / 'tutorial' / 'test_your_node.md'
ROBOT = {'wheel_radius': 0.033, 'wheel_separation': 0.16, 'enable_odom_tf': False}
NOISE = {'left_bias': 0.01, 'left_slip_variance': 1e-5, 'right_slip_variance': 1e-5, 'seed': 3}
SPIN = 'rclpy.spin(MyPlanner())'
OTHERS = {
    'in_lockstep': [(SPIN, 'from diffdrive_kinematics.testing import spin\nspin(MyPlanner())')],
    # what it does depends on whether the clock or the odometry comes first
    'reads_clock': [
        ('        self.pose = place.x', """\
        stamp = message.header.stamp
        self.age = self.get_clock().now().nanoseconds / 1e9 - stamp.sec - stamp.nanosec / 1e9
        self.pose = place.x"""),
        ('            if distance >', '            error += self.age\n            if distance >')],
    # what it does depends on when its thread comes to it
    'has_thread': [
        (SPIN, """\
def plan():
    while rclpy.ok():
        time.sleep(0.002)
        node.on_timer()


node = MyPlanner()
threading.Thread(target=plan, daemon=True).start()
rclpy.spin(node)"""),
        ('        self.create_timer(0.02, self.on_timer)\n', ''),
        ('import math\n', 'import math\nimport threading\nimport time\n')],
    'never_rests': [(SPIN, """\
node = MyPlanner()
while rclpy.ok():
    rclpy.spin_once(node, timeout_sec=0)""")]}


def shown():
    """Return the names of the files that the tutorial shows, and what is in them."""
    return dict(re.findall(r'^```python\n# (\S+)\n(.*?)^```', PAGE.read_text(), re.M | re.S))


def write(directory):
    """Write the files of the tutorial, and the other planners, into a directory."""
    files = shown()
    assert [*files] == ['my_planner.py', 'test_my_planner.py']
    for name, changes in OTHERS.items():
        text = files['my_planner.py']
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        files[f'{name}.py'] = text
    files['reads_clock_in_lockstep.py'] = files['reads_clock.py'].replace(
        *OTHERS['in_lockstep'][0])
    for name, text in files.items():
        (directory / name).write_text(text)
    return directory
