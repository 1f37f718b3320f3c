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
What the nodes cost, beside the least that a Python node can cost, in one run.

Run by hand on a machine that is otherwise idle::

    python test/benchmark/bench_nodes.py [--rounds 5] [--seconds 8] [--json FILE]
        [--peer NAME 'ARGV ...'] [--rates] [--robots]

Each round starts every subject once, one after the other: the floor (floor_node.py), the base
alone, the stack (controller and base in one process), and peers, which have to publish odom.
They hear wheel rates (the stack: cmd_vel) at 50 Hz and publish odometry and joint states at
100 Hz.  Printed: CPU over all threads per cent of a core, and per odometry; resident memory; the
time from the start of the process to the first odometry; the scatter of the times between
odometries by their stamps and arrivals; as min, median and max over the rounds, and the ratio
of the medians to the floor.  ``--rates`` (10 Hz to 1 kHz) and ``--robots`` (1 to 50 in a process)
show how the cost of the base grows.
"""

import argparse
import json
import os
from pathlib import Path
import shlex
import statistics
import subprocess
import sys
import tempfile
import time

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import rclpy
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import JointState

HERE = Path(__file__).resolve().parent
TICKS = os.sysconf('SC_CLK_TCK')
GEOMETRY = ['wheel_radius:=0.033', 'wheel_separation:=0.16', 'enable_odom_tf:=false']
START_TIMEOUT_S, WARM_UP_S, IN_RATE = 60.0, 2.0, 50.0
FIRST_DOMAIN = 60
FILES = tempfile.TemporaryDirectory()


def ros_arguments(*parameters):
    """Return the command line that sets parameters."""
    return ['--ros-args', *(part for each in parameters for part in ('-p', each))]


def package(executable, *parameters):
    """Return the argv of an executable of the package."""
    start = f'from diffdrive_kinematics.executables import {executable}; {executable}()'
    return [sys.executable, '-c', start, *ros_arguments(*GEOMETRY, *parameters)]


def base(rate):
    """Return the argv of the base alone."""
    return package('simulated_base', f'publish_rate:={float(rate)}')


def simulation(nodes, rate):
    """Return the argv of nodes in one process, by a params file of their own."""
    lines = ['/**:', '  ros__parameters:', f'    nodes: [{", ".join(map(repr, nodes))}]',
             *(f'    {each.replace(":=", ": ")}' for each in GEOMETRY),
             '/**/simulated_base:', f'  ros__parameters: {{publish_rate: {float(rate)}}}',
             '/**/base:', f'  ros__parameters: {{publish_rate: {float(rate)}}}']
    file = Path(FILES.name) / f'{len(nodes)}_{rate}.yaml'
    file.write_text('\n'.join(lines) + '\n')
    start = 'from diffdrive_kinematics.executables import diffdrive_sim; diffdrive_sim()'
    return [sys.executable, '-c', start, '--ros-args', '--params-file', str(file)]


def stack(rate):
    """Return the argv of controller and base in one process."""
    return simulation(['diff_drive_controller', 'simulated_base'], rate)


def fleet(robots, rate):
    """Return the argv of bases in one process."""
    return simulation([f'simulated_base:robot{n}/base' for n in range(robots)], rate)


def cpu_seconds(pid):
    """Return the CPU time [s] of all threads of a process."""
    fields = Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def resident_mib(pid):
    """Return the resident memory [MiB] of a process."""
    lines = Path(f'/proc/{pid}/status').read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith('VmRSS')) / 1024.0


class Run:
    """One process, driven and measured."""

    def __init__(self, argv, domain, topics=('odom',)):
        self.environment = {**os.environ, 'ROS_DOMAIN_ID': str(domain),
                            'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain)
        self.node = rclpy.create_node('bench', context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.arrivals, self.stamps = [], []
        prefixes = sorted({topic.rpartition('odom')[0] for topic in topics})
        self.wheels = [self.node.create_publisher(JointState, f'{prefix}wheel_rates', 10)
                       for prefix in prefixes]
        self.commands = self.node.create_publisher(Twist, 'cmd_vel', 10)
        for topic in topics:
            self.node.create_subscription(Odometry, topic, self._on_odometry, 100)
        self.node.create_timer(1.0 / IN_RATE, self._drive)
        self.count = 0
        self.begun = time.monotonic()
        self.process = subprocess.Popen(
            argv, env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def _on_odometry(self, message):
        self.arrivals.append(time.monotonic())
        self.stamps.append(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)

    def _drive(self):
        self.count += 1
        message = JointState(name=['left_wheel_joint', 'right_wheel_joint'],
                             velocity=[5.0 + 0.001 * (self.count % 7), 6.0])
        message.header.stamp = self.node.get_clock().now().to_msg()
        for publisher in self.wheels:
            publisher.publish(message)
        command = Twist()
        command.linear.x, command.angular.z = 0.15 + 1e-4 * (self.count % 7), 0.2
        self.commands.publish(command)

    def spin(self, until, timeout):
        """Spin until a condition holds, and return whether it did."""
        end = time.monotonic() + timeout
        while not until():
            if time.monotonic() > end or self.process.poll() is not None:
                return False
            self.executor.spin_once(timeout_sec=0.05)
        return True

    def measure(self, seconds):
        """Return what the process costs, or None if it does not publish."""
        if not self.spin(lambda: self.arrivals, START_TIMEOUT_S):
            return None
        start_up = self.arrivals[0] - self.begun
        self.spin(lambda: False, WARM_UP_S)
        pid, first = self.process.pid, len(self.arrivals)
        cpu, wall = cpu_seconds(pid), time.monotonic()
        self.spin(lambda: False, seconds)
        cpu, wall = cpu_seconds(pid) - cpu, time.monotonic() - wall
        heard = len(self.arrivals) - first
        gaps = [1e3 * (b - a) for a, b in zip(self.stamps[first:], self.stamps[first + 1:])]
        return {
            'CPU [% of a core]': 100.0 * cpu / wall,
            'CPU per odometry [us]': 1e6 * cpu / max(1, heard),
            'odometry [Hz]': heard / wall,
            'jitter by stamps, std [ms]': statistics.pstdev(gaps) if gaps else float('nan'),
            'resident memory [MiB]': resident_mib(pid),
            'start to first odometry [s]': start_up}

    def close(self):
        """End the process and the listener."""
        self.process.kill()
        self.process.wait()
        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown(context=self.context)


def measured(argv, domain, seconds, topics=('odom',)):
    """Start, measure and end a process."""
    run = Run(argv, domain, topics)
    try:
        return run.measure(seconds)
    finally:
        run.close()


def interleaved(subjects, rounds, seconds):
    """Return the figures of each subject and round."""
    results = {name: [] for name in subjects}
    for number in range(rounds):
        for offset, (name, (argv, topics)) in enumerate(subjects.items()):
            figures = measured(argv, FIRST_DOMAIN + offset, seconds, topics)
            if figures is None:
                sys.exit(f'{name} published no odometry: {shlex.join(argv)}')
            results[name].append(figures)
            print(f'  round {number + 1}, {name}: {figures["CPU [% of a core]"]:.1f} %',
                  file=sys.stderr, flush=True)
    return results


def show(results, reference):
    """Print a table: min, median, max of each figure, and medians over the reference's."""
    for figure in next(iter(results.values()))[0]:
        print(f'\n{figure:32s}{"min":>10}{"median":>10}{"max":>10}{"ratio":>10}')
        least = statistics.median(row[figure] for row in results[reference])
        for name, rows in results.items():
            values = [row[figure] for row in rows]
            middle = statistics.median(values)
            print(f'  {name:30s}{min(values):10.3f}{middle:10.3f}{max(values):10.3f}'
                  f'{middle / least if least else float("nan"):10.2f}')


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description='What the nodes cost.')
    parser.add_argument('--rounds', type=int, default=5)
    parser.add_argument('--seconds', type=float, default=8.0)
    parser.add_argument('--json', type=Path)
    parser.add_argument('--peer', nargs=2, action='append', default=[], metavar=('NAME', 'ARGV'))
    parser.add_argument('--rates', action='store_true')
    parser.add_argument('--robots', action='store_true')
    options = parser.parse_args()
    floor = [sys.executable, str(HERE / 'floor_node.py')]
    everything = {}

    def run(title, subjects, reference):
        print(f'\n{title}: {options.rounds} interleaved rounds of {options.seconds:g} s')
        everything[title] = interleaved(subjects, options.rounds, options.seconds)
        show(everything[title], reference)

    run('100 Hz', {
        'floor': ([*floor, '100'], ('odom',)), 'base': (base(100), ('odom',)),
        'stack': (stack(100), ('odom',)),
        **{name: (shlex.split(argv), ('odom',)) for name, argv in options.peer}}, 'floor')
    if options.rates:
        for rate in (10, 100, 1000):
            run(f'{rate} Hz', {'floor': ([*floor, str(rate)], ('odom',)),
                               'base': (base(rate), ('odom',))}, 'floor')
    if options.robots:
        run('robots at 20 Hz', {
            f'{n} robots': (fleet(n, 20), tuple(f'robot{i}/odom' for i in range(n)))
            for n in (1, 10, 50)}, '1 robots')
    if options.json:
        options.json.write_text(json.dumps(everything, indent=1))


if __name__ == '__main__':
    main()
