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
Measure what the page of web_view costs, and how soon a key moves the wheels, in a real browser.

``python test/benchmark/bench_web_view.py [--minutes N]``, with chromium and the extras ``ros``,
``web`` and ``browser``.  The page has a process of its own beside the robot of web.yaml.
"""

import argparse
import os
from pathlib import Path
import re
import select
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

from playwright.sync_api import sync_playwright
import rclpy
from sensor_msgs.msg import JointState

CONFIG = Path(__file__).parents[2] / 'config' / 'web.yaml'
TRIES, LOOK_S, DEADLINE_S = 20, 20.0, 60.0
TICKS = os.sysconf('SC_CLK_TCK')


class Measured:
    """A process, its processor time and its memory."""

    def __init__(self, name, params, log):
        self.process = subprocess.Popen(
            [Path(sys.executable).parent / name, '--ros-args', '--params-file', params],
            stdout=log, stderr=subprocess.STDOUT)

    def seconds(self):
        fields = Path(f'/proc/{self.process.pid}/stat').read_text().rpartition(')')[2].split()
        return (int(fields[11]) + int(fields[12])) / TICKS

    def megabytes(self):
        status = Path(f'/proc/{self.process.pid}/status').read_text()
        return int(re.search(r'VmRSS:\s+(\d+)', status)[1]) / 1000.0


def shares(what, page, robot):
    """Print the shares of a core that page and robot take."""
    before, began = (page.seconds(), robot.seconds()), time.monotonic()
    select.select([], [], [], LOOK_S)
    seconds = time.monotonic() - began
    print(f'{what}: page {100.0 * (page.seconds() - before[0]) / seconds:.1f} %, robot '
          f'{100.0 * (robot.seconds() - before[1]) / seconds:.1f} % of a core, page '
          f'{page.megabytes():.1f} MB', flush=True)


def delays(keyboard):
    """Return the times [s] from a key that goes down to the first wheel rate that is not 0."""
    node, moving = rclpy.create_node('bench_web_view'), []
    node.create_subscription(
        JointState, 'wheel_rates', lambda message: moving.append(any(message.velocity)), 100)

    def wait_for(state):
        moving.clear()
        end = time.monotonic() + DEADLINE_S
        while not (moving and moving[-1] is state):
            assert time.monotonic() < end, 'no wheel rates'
            rclpy.spin_once(node, timeout_sec=0.01)

    found = []
    for _ in range(TRIES):
        wait_for(False)
        began = time.monotonic()
        keyboard.down('w')
        wait_for(True)
        found.append(time.monotonic() - began)
        keyboard.up('w')
    node.destroy_node()
    return found


def main():
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[1])
    parser.add_argument('--minutes', type=float, default=10.0)
    minutes = parser.parse_args().minutes
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    directory = Path(tempfile.mkdtemp())
    log, robot_yaml = directory / 'log', directory / 'robot.yaml'
    robot_yaml.write_text(CONFIG.read_text().replace('      - web_view\n', ''))
    with log.open('w') as output:
        robot, page = (Measured('diffdrive_sim', robot_yaml, output),
                       Measured('web_view', CONFIG, output))
        try:
            measure(log, page, robot, minutes)
        finally:
            for each in (page, robot):
                each.process.terminate()
                each.process.wait(DEADLINE_S)
            shutil.rmtree(directory)


def measure(log, page, robot, minutes):
    end = time.monotonic() + DEADLINE_S
    while not (found := re.search(r'open (http://\S+)', log.read_text())):
        assert time.monotonic() < end, log.read_text()
        select.select([], [], [], 0.1)
    shares('nobody looks', page, robot)
    with sync_playwright() as started:
        browser = started.chromium.launch(
            executable_path=shutil.which('chromium'), args=['--no-sandbox'])
        view = browser.new_page(viewport={'width': 1280, 'height': 800})
        view.goto(found.group(1))
        view.wait_for_function('window.webView && webView.lost === false')
        shares('one looks, at rest', page, robot)
        rclpy.init()
        found = delays(view.keyboard)
        rclpy.shutdown()
        print(f'key to wheels: median {1e3 * statistics.median(found):.0f} ms, slowest '
              f'{1e3 * max(found):.0f} ms of {TRIES}', flush=True)
        began, keys = time.monotonic(), ['a', 'd']
        view.keyboard.down('w')
        while (passed := time.monotonic() - began) < 60.0 * minutes:
            view.keyboard.down(keys[0])
            shares(f'driving for {passed:.0f} s', page, robot)
            view.keyboard.up(keys[0])
            keys.reverse()
        browser.close()


if __name__ == '__main__':
    main()
