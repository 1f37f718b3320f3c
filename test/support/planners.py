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
import sys

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

PACKAGE = {
    'resource/my_package': '', 'my_package/__init__.py': '',
    'package.xml': """\
<?xml version="1.0"?>
<package format="3">
  <name>my_package</name>
  <version>0.0.1</version>
  <description>A planner</description>
  <maintainer email="me@example.org">me</maintainer>
  <license>Apache-2.0</license>
  <exec_depend>rclpy</exec_depend>
  <test_depend>diffdrive_kinematics</test_depend>
  <test_depend>python3-pytest</test_depend>
  <export><build_type>ament_python</build_type></export>
</package>
""",
    'setup.cfg': """\
[develop]
script_dir=$base/lib/my_package
[install]
install_scripts=$base/lib/my_package
""",
    'setup.py': """\
from setuptools import setup

setup(
    name='my_package', version='0.0.1', packages=['my_package'],
    data_files=[('share/ament_index/resource_index/packages', ['resource/my_package']),
                ('share/my_package', ['package.xml'])],
    install_requires=['setuptools'], extras_require={'test': ['pytest']})
"""}


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


def write_package(directory):
    """Write a package of a user, with the files of the tutorial, into a new directory."""
    files = {f'test/{name}' if name.startswith('test_') else name: text
             for name, text in shown().items()}
    for name, text in {**files, **PACKAGE}.items():
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


if __name__ == '__main__':
    {'files': write, 'package': write_package}[sys.argv[1]](Path(sys.argv[2]))
