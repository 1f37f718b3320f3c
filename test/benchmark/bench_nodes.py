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
What the nodes cost and how soon they answer, beside hand-written nodes, in one run.

Run by hand on a machine that is otherwise idle::

    python test/benchmark/bench_nodes.py [--rounds 5] [--seconds 8] [--json FILE]
        [--peer NAME 'ARGV ...'] [--tree NAME DIRECTORY] [--latency] [--rates] [--robots]

Each round starts every subject once, one after the other: a node that publishes prebuilt bytes
(prebuilt_node.py), the limit of what a base in Python can be (flat_node.py), the base alone, the
stack (controller and base in one process), both with the covariance of slipping wheels, and
peers, which have to publish odom.  They hear wheel rates (the stack: cmd_vel) at 50 Hz and
publish odometry and joint states at 100 Hz.  Printed: CPU over all threads per cent of a core, and
per odometry; resident memory; the time from the start of the process to the first odometry; the
scatter of the times between odometries by their stamps; ticks that came late by more than half a
period, or never; from cmd_vel to the first odometry with its speed; as min, median and max over
the rounds, and the ratio of the medians to those of the prebuilt node.  ``--tree`` adds base and
stack of another checkout.

``--latency``: from cmd_vel to wheel_rates, of the controller and of relay_node.py, from before a
command is published until DDS has the answer.  ``--rates`` (10 Hz to 1 kHz) and ``--robots`` (1 to
50 in a process) show how the cost of the base grows.
"""

import argparse
import compileall
import importlib.util
import json
import math
import os
from pathlib import Path
import shlex
import statistics
import struct
import subprocess
import sys
import tempfile
import time

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

HERE = Path(__file__).resolve().parent
TICKS = os.sysconf('SC_CLK_TCK')
RADIUS, SEPARATION = 0.033, 0.16
SETTINGS = [f'wheel_radius:={RADIUS}', f'wheel_separation:={SEPARATION}', 'enable_odom_tf:=false',
            'left_slip_variance:=1e-4', 'right_slip_variance:=1e-4']
START_TIMEOUT_S, WARM_UP_S, IN_RATE = 120.0, 2.0, 50.0
FIRST_DOMAIN = 60
FILES = tempfile.TemporaryDirectory()
STAMP = struct.Struct('=iI')
SPEED_AT, ODOMETRY_TAIL = 43 * 8, 85 * 8  # of twist.linear.x among the doubles that end it
SPEEDS = 500  # how many commands differ from each other


def ros_arguments(*parameters):
    """Return the command line that sets parameters."""
    return ['--ros-args', *(part for each in parameters for part in ('-p', each))]


def package(executable, *parameters):
    """Return the argv of an executable of the package."""
    start = f'from diffdrive_kinematics.executables import {executable}; {executable}()'
    return [sys.executable, '-c', start, *ros_arguments(*SETTINGS, *parameters)]


def base(rate):
    """Return the argv of the base alone."""
    return package('simulated_base', f'publish_rate:={float(rate)}')


def simulation(nodes, rate):
    """Return the argv of nodes in one process, by a params file of their own."""
    lines = ['/**:', '  ros__parameters:', f'    nodes: [{", ".join(map(repr, nodes))}]',
             *(f'    {each.replace(":=", ": ")}' for each in SETTINGS),
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


def late_share(stamps, rate):
    """Return which part of the ticks [%] came late by more than half a period, or never."""
    turns = [2.0 * math.pi * rate * (stamp - stamps[0]) for stamp in stamps]
    phase = math.atan2(sum(map(math.sin, turns)), sum(map(math.cos, turns)))
    ticks = {round((turn - phase) / (2.0 * math.pi)) for turn in turns}
    expected = max(ticks) - min(ticks) + 1
    return 100.0 * (expected - len(ticks)) / expected


def percentile(values, part):
    """Return a percentile of values; NaN where there are none."""
    if not values:
        return float('nan')
    return sorted(values)[min(len(values) - 1, int(part * len(values)))]


class Subject:
    """What is measured: argv, its odometry topics and their rate, and another source tree."""

    def __init__(self, argv, rate=100, topics=('odom',), tree=None, relays=False, drives=False):
        self.argv, self.rate, self.topics = argv, rate, topics
        self.drives = drives  # its own controller says the wheel rates
        self.relays = relays  # whatever comes on wheel_rates answers a command
        self.tree = tree
        self.environment = {} if tree is None else {'PYTHONPATH': str(tree)}


class Run:
    """One process, driven and measured."""

    def __init__(self, subject, domain):
        self.subject = subject
        environment = {**os.environ, **subject.environment, 'ROS_DOMAIN_ID': str(domain),
                       'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain)
        self.node = rclpy.create_node('bench', context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.arrivals, self.stamps = dict.fromkeys(subject.topics, 0), []
        prefixes = sorted({topic.rpartition('odom')[0] for topic in subject.topics})
        self.wheels = [self.node.create_publisher(JointState, f'{prefix}wheel_rates', 10)
                       for prefix in prefixes] if not subject.drives else []
        self.commands = self.node.create_publisher(Twist, 'cmd_vel', 10)
        self.asked, self.latencies = {}, {'wheel_rates': [], 'odom': []}
        for topic in subject.topics:
            self.node.create_subscription(
                Odometry, topic, self._odometry_of(topic), 100, raw=True)
        if not subject.topics:
            self.node.create_subscription(JointState, 'wheel_rates', self._on_rates, 100, raw=True)
        self.node.create_timer(1.0 / IN_RATE, self._drive)
        self.count, self.first_s = 0, None
        self.begun = time.monotonic()
        self.process = subprocess.Popen(
            subject.argv, env=environment, cwd=subject.tree, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)

    def _odometry_of(self, topic):
        first = topic == self.subject.topics[0]

        def on_odometry(data, info):
            if self.first_s is None:
                self.first_s = time.monotonic() - self.begun
            self.arrivals[topic] += 1
            if first:
                sec, nanosec = STAMP.unpack_from(data, 4)
                self.stamps.append(sec + 1e-9 * nanosec)
                speed, = struct.unpack_from('=d', data, len(data) - ODOMETRY_TAIL + SPEED_AT)
                self._answered('odom', speed, info)

        return on_odometry

    def _on_rates(self, data, info):
        left, right = struct.unpack_from('=2d', data, len(data) - 20)  # no effort: a count ends it
        self._answered('wheel_rates', 0.5 * RADIUS * (left + right), info)

    def _answered(self, topic, speed, info):
        key = self.count if self.subject.relays else round(1e6 * speed)
        sent_ns = self.asked.pop((topic, key), None)
        if sent_ns is not None:
            self.latencies[topic].append((info['received_timestamp'] - sent_ns) / 1e3)

    def _drive(self):
        self.count += 1
        part = self.count % SPEEDS
        message = JointState(name=['left_wheel_joint', 'right_wheel_joint'],
                             velocity=[5.0 + 1e-3 * part, 6.0])
        message.header.stamp = self.node.get_clock().now().to_msg()
        wheels = bytes(serialize_message(message))
        for publisher in self.wheels:
            publisher.publish(wheels)
        command = Twist()
        command.linear.x, command.angular.z = 0.15 + 1e-4 * part, 0.2
        self.asked.clear()
        key = self.count if self.subject.relays else round(1e6 * command.linear.x)
        data = bytes(serialize_message(command))
        self.asked['wheel_rates', key] = self.asked['odom', key] = time.time_ns()
        self.commands.publish(data)

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
        if not self.spin(lambda: all(self.arrivals.values()), START_TIMEOUT_S):
            return None
        if not self.subject.topics and not self.spin(
                lambda: self.latencies['wheel_rates'], START_TIMEOUT_S):
            return None
        self.spin(lambda: False, WARM_UP_S)
        for values in self.latencies.values():
            values.clear()
        pid, first, heard = self.process.pid, len(self.stamps), sum(self.arrivals.values())
        cpu, wall = cpu_seconds(pid), time.monotonic()
        self.spin(lambda: False, seconds)
        cpu, wall = cpu_seconds(pid) - cpu, time.monotonic() - wall
        heard = sum(self.arrivals.values()) - heard
        figures = {'CPU [% of a core]': 100.0 * cpu / wall}
        if not self.subject.topics:
            for part in (50, 99):
                figures[f'cmd_vel to wheel_rates p{part} [us]'] = percentile(
                    self.latencies['wheel_rates'], part / 100)
            return figures
        stamps = self.stamps[first:]
        gaps = [1e3 * (b - a) for a, b in zip(stamps, stamps[1:])]
        return {
            **figures, 'CPU per odometry [us]': 1e6 * cpu / max(1, heard),
            'odometry [Hz]': heard / wall / len(self.subject.topics),
            'jitter by stamps, std [ms]': statistics.pstdev(gaps) if gaps else float('nan'),
            'late or missing [%]': late_share(stamps, self.subject.rate),
            'cmd_vel to odom p50 [ms]': percentile(self.latencies['odom'], 0.5) / 1e3,
            'cmd_vel to odom p99 [ms]': percentile(self.latencies['odom'], 0.99) / 1e3,
            'resident memory [MiB]': resident_mib(pid),
            'start to first odometry [s]': self.first_s}

    def close(self):
        """End the process and the listener."""
        self.process.terminate()
        self.process.wait()
        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown(context=self.context)


def measured(subject, domain, seconds):
    """Start, measure and end a process."""
    run = Run(subject, domain)
    try:
        return run.measure(seconds)
    finally:
        run.close()


def interleaved(subjects, rounds, seconds):
    """Return the figures of each subject and round."""
    results = {name: [] for name in subjects}
    for number in range(rounds):
        for offset, (name, subject) in enumerate(subjects.items()):
            figures = measured(subject, FIRST_DOMAIN + offset, seconds)
            if figures is None:
                sys.exit(f'{name} published nothing: {shlex.join(subject.argv)}')
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
                  f'{middle / least if least else float("nan"):10.2f}', flush=True)


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description='What the nodes cost.')
    parser.add_argument('--rounds', type=int, default=5)
    parser.add_argument('--seconds', type=float, default=8.0)
    parser.add_argument('--json', type=Path)
    parser.add_argument('--peer', nargs=2, action='append', default=[], metavar=('NAME', 'ARGV'))
    parser.add_argument(
        '--tree', nargs=2, action='append', default=[], metavar=('NAME', 'DIRECTORY'))
    for option in ('latency', 'rates', 'robots'):
        parser.add_argument(f'--{option}', action='store_true')
    options = parser.parse_args()
    prebuilt, flat = ([sys.executable, str(HERE / f'{name}_node.py')] for name in (
        'prebuilt', 'flat'))
    relay = [sys.executable, str(HERE / 'relay_node.py')]
    everything = {}

    def run(title, subjects, reference):
        print(f'\n{title}: {options.rounds} interleaved rounds of {options.seconds:g} s')
        everything[title] = interleaved(subjects, options.rounds, options.seconds)
        show(everything[title], reference)

    trees = {name: Path(directory).resolve() for name, directory in options.tree}
    here = Path(importlib.util.find_spec('diffdrive_kinematics').origin).parents[1]
    for tree in (here, *trees.values()):  # as an installation does
        compileall.compile_dir(tree / 'diffdrive_kinematics', quiet=1)
    run('100 Hz', {
        'prebuilt': Subject([*prebuilt, '100']), 'flat': Subject([*flat, '100']),
        'base': Subject(base(100)),
        'stack': Subject(stack(100), drives=True),
        **{f'base, {name}': Subject(base(100), tree=tree) for name, tree in trees.items()},
        **{f'stack, {name}': Subject(stack(100), tree=tree, drives=True)
           for name, tree in trees.items()},
        **{name: Subject(shlex.split(argv)) for name, argv in options.peer}}, 'prebuilt')
    if options.latency:
        run('answers', {
            'relay of bytes': Subject([*relay, 'bytes'], topics=(), relays=True),
            'relay of objects': Subject([*relay, 'objects'], topics=(), relays=True),
            'controller': Subject(package('diff_drive_controller'), topics=()),
            **{f'controller, {name}': Subject(
                package('diff_drive_controller'), topics=(), tree=tree)
                for name, tree in trees.items()}}, 'relay of objects')
    if options.rates:
        for rate in (10, 100, 1000):
            run(f'{rate} Hz', {'prebuilt': Subject([*prebuilt, str(rate)], rate),
                               'base': Subject(base(rate), rate)}, 'prebuilt')
    if options.robots:
        run('robots at 20 Hz', {
            f'{n} robots': Subject(
                fleet(n, 20), 20, tuple(f'robot{i}/odom' for i in range(n)))
            for n in (1, 10, 50)}, '1 robots')
    if options.json:
        options.json.write_text(json.dumps(everything, indent=1))


if __name__ == '__main__':
    main()
