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
A graph of real processes over DDS in a domain of its own, and the test's node in it.

Nothing sleeps: every wait is for an event, with a deadline that only a hung graph reaches.
"""

import math
import os
from pathlib import Path
import signal
import subprocess
import sys
import tempfile
import time

from diffdrive_kinematics.core.kinematics import Pose
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Empty
from support.killing import delete_left, kill
import yaml

DEADLINE_S = 90.0
ANSWER_S = 10.0
START = 'from diffdrive_kinematics.executables import {0}; {0}()'  # what the scripts do
DEEP = QoSProfile(depth=100_000)
JOINTS = ['left_wheel_joint', 'right_wheel_joint']
CONFIG = Path(__file__).resolve().parents[2] / 'config'
KHEPERA = {'wheel_radius': 0.021, 'wheel_separation': 0.0885}


def arguments(parameters, *extra):
    """Return ROS arguments that set parameters of whatever node is started."""
    settings = [part for name, value in parameters.items()
                for part in ('-p', f'{name}:={_yaml(value)}')]
    return ['--ros-args', *settings, *extra]


def _yaml(value):
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_yaml, value))}]"
    return f"'{value}'" if value == '' else repr(value) if isinstance(value, float) else str(value)


class Process:
    """An executable of the package in a process of its own; its output goes to a file."""

    def __init__(self, name, args, environment, cwd=None, before=''):
        self.name = name
        self._file = tempfile.TemporaryFile(mode='w+')
        self._popen = subprocess.Popen(
            [sys.executable, '-c', before + START.format(name), *args],
            stdin=subprocess.DEVNULL, stdout=self._file, stderr=subprocess.STDOUT,
            env=environment, cwd=cwd)

    @property
    def pid(self):
        return self._popen.pid

    @property
    def running(self):
        return self._popen.poll() is None

    @property
    def output(self):
        self._file.seek(0)
        return self._file.read()

    def send(self, number):
        if number == signal.SIGKILL:
            kill(self._popen)
        elif self.running:
            self._popen.send_signal(number)

    def stop(self, number=signal.SIGINT):
        """Send a signal, and return the exit status."""
        self.send(number)
        return self.wait()

    def wait(self, timeout=DEADLINE_S):
        """Return the exit status of a process that ends by itself."""
        try:
            return self._popen.wait(timeout)
        except subprocess.TimeoutExpired:
            raise AssertionError(f'{self.name} does not end:\n{self.output}') from None

    def kill(self):
        kill(self._popen)
        self._file.close()


class Graph:
    """Starts processes and talks to them."""

    def __init__(self, domain):
        self._environment = {
            **os.environ, 'ROS_DOMAIN_ID': str(domain), 'ROS_PYTHON_CHECK_FIELDS': '1',
            'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'PYTHONUNBUFFERED': '1',
            'RCUTILS_COLORIZED_OUTPUT': '0'}
        self._environment.setdefault('ROS_LOG_DIR', tempfile.gettempdir())
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain)
        self.node = rclpy.create_node(
            'test', context=self.context, start_parameter_services=False)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.processes = []
        self._clients = {}

    def start(self, name, parameters=None, *extra, args=None, cwd=None, environment=None,
              before=''):
        """Start an executable with parameters, or with ``args``, ``before`` it other code."""
        process = Process(
            name, arguments(parameters or {}, *extra) if args is None else args,
            {**self._environment, **(environment or {})}, cwd, before)
        self.processes.append(process)
        return process

    def simulate(self, directory, *members, **parameters):
        """Start nodes in one process, by a params file that holds for all of them."""
        file = directory / 'simulation.yaml'
        file.write_text(yaml.safe_dump({
            '/**': {'ros__parameters': {'nodes': list(members), **parameters}}}))
        return self.start('diffdrive_sim', None, '--params-file', str(file))

    def close(self):
        """
        End all; the node of the test first.

        Who is killed while it writes into the shared memory of another one leaves it locked.  Fast
        DDS then makes that anew, and dies of a segmentation fault if it ends meanwhile.
        """
        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown(context=self.context)
        for process in self.processes:
            process.kill()
        delete_left()

    def wait_for(self, condition, what, timeout=DEADLINE_S):
        """Spin until the condition returns something true, and return that."""
        deadline = time.monotonic() + timeout
        while not (result := condition()):
            if time.monotonic() > deadline:
                raise AssertionError(f'{what}: not within {timeout} s\n{self.outputs()}')
            self.executor.spin_once(timeout_sec=0.05)
        return result

    def hold_up(self, process, seconds, meanwhile=lambda: None):
        """Stop a process for some seconds of real time, in which something is said to it."""
        process.send(signal.SIGSTOP)
        meanwhile()
        over = time.monotonic() + seconds
        self.wait_for(lambda: time.monotonic() > over, 'the stall')
        process.send(signal.SIGCONT)

    def outputs(self):
        return '\n'.join(f'--- {process.name}\n{process.output}' for process in self.processes)

    def collect(self, message_type, topic, handle=None):
        """
        Return a list to which every message of a topic is added.

        Its publisher may find this reader seconds after it has found another one, and what it
        says until then is lost here: only a first message shows that the next will be heard.
        """
        messages = []
        self.node.create_subscription(message_type, topic, handle or messages.append, DEEP)
        return messages

    def publisher(self, message_type, topic, listeners=1):
        """Return a publisher that so many listeners hear, or will: nothing is lost to them."""
        publisher = self.node.create_publisher(message_type, topic, DEEP)
        if listeners:
            self.wait_for(lambda: publisher.get_subscription_count() >= listeners,
                          f'{listeners} subscribers of {topic}')
        return publisher

    def wait_for_rest(self, wheels, odometry, since_ns=None, wait_for=None):
        """
        Wait until all wheels were told to stand, and all odometry knows of it.

        Parameters
        ----------
        wheels, odometry : list of list
            What was collected of JointState and of Odometry.
        since_ns : int, optional
            The time [ns] on the clock of the nodes: what is stamped before it tells nothing, and
            may lie in the queues of a test that was held up.  Default: this time.
        wait_for : callable, optional
            What waits meanwhile, where time is simulated.

        """
        since_ns, wait_for = since_ns or self.now_ns(), wait_for or self.wait_for

        def at_rest():
            return all(heard and stamp_ns(heard[-1]) > since_ns
                       for heard in (*wheels, *odometry)) and not any(
                           any(heard[-1].velocity) for heard in wheels)

        wait_for(at_rest, 'the wheels to stand')
        known = [len(heard) + 5 for heard in odometry]  # by then all that had come has been read
        wait_for(lambda: at_rest() and all(
            len(heard) > count and heard[-1].twist.twist.linear.x == 0.0
            for heard, count in zip(odometry, known)), 'odometry at rest')

    def play_out(self, sim, go):
        """Let the sequence go that waits for a topic, and wait until its process has ended."""
        self.wait_for(go.get_subscription_count, 'the sequence to listen')
        go.publish(Empty())
        self.wait_for(lambda: not sim.running, 'the course to end')
        assert sim.wait() == 0, sim.output

    def now_ns(self):
        return self.node.get_clock().now().nanoseconds

    def call(self, service_type, name, request):
        """
        Call a service and return the response.

        An answer that is sent before the server has found the client's reader is lost (rmw says
        "client will not receive response"), so it is asked for again.
        """
        if name not in self._clients:
            self._clients[name] = self.node.create_client(service_type, name)
        client = self._clients[name]
        self.wait_for(client.service_is_ready, f'service {name}')
        ask_again_at = 0.0

        def answered():
            nonlocal future, ask_again_at
            if time.monotonic() > ask_again_at:
                ask_again_at = time.monotonic() + ANSWER_S
                future = client.call_async(request)
            return future.done()

        future = None
        self.wait_for(answered, f'answer of {name}')
        return future.result()


class SimulatedTime:
    """A /clock that goes on while the test waits."""

    def __init__(self, graph, now_ns=3600 * 10**9, step_ns=10_000_000):
        self._graph, self.now_ns, self._step_ns = graph, now_ns, step_ns
        self._publisher = graph.node.create_publisher(Clock, '/clock', 1)

    def go_on(self):
        self.now_ns += self._step_ns
        self._publisher.publish(clock_at(self.now_ns))

    def wait_for(self, condition, what):
        """Let time go on until the condition returns something true, and return that."""
        return self._graph.wait_for(lambda: self.go_on() or condition(), what)


def stamp_ns(message):
    """Return the stamp of a message with a header."""
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def set_stamp(message, time_ns):
    """Write a stamp [ns] into a message with a header."""
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(time_ns, 10**9)


def wheel_motion(time_ns, position=(), velocity=(), *, names=JOINTS, frame_id=''):
    """Return a JointState."""
    message = JointState(name=list(names), position=[float(value) for value in position],
                         velocity=[float(value) for value in velocity])
    set_stamp(message, time_ns)
    message.header.frame_id = frame_id
    return message


def put(message, x, y, yaw):
    """Write a pose in the plane into a message of the kind Pose."""
    message.position.x, message.position.y = float(x), float(y)
    message.orientation.z, message.orientation.w = math.sin(0.5 * yaw), math.cos(0.5 * yaw)


def odometry_of(time_ns, pose, frame='odom', child=''):
    """Return the Odometry of a robot that stands."""
    message = Odometry(child_frame_id=child)
    message.header.frame_id = frame
    set_stamp(message, time_ns)
    put(message.pose.pose, *pose)
    return message


def clock_at(time_ns):
    """Return a Clock."""
    message = Clock()
    message.clock.sec, message.clock.nanosec = divmod(time_ns, 10**9)
    return message


def pose_of(message):
    """Return the pose in the plane of an Odometry."""
    at, orientation = message.pose.pose.position, message.pose.pose.orientation
    return Pose(at.x, at.y, 2.0 * math.atan2(orientation.z, orientation.w))


def assert_pose(pose, expected, within=1e-9):
    """Compare poses in the plane."""
    assert math.dist(pose[:2], expected[:2]) < within
    assert abs(math.remainder(pose[2] - expected[2], math.tau)) < 1e-9


def x_of(odometry):
    """Return how far ahead the last of the messages is."""
    return odometry[-1].pose.pose.position.x


def twist(v, w):
    """Return a Twist."""
    message = Twist()
    message.linear.x, message.angular.z = float(v), float(w)
    return message


def twist_stamped(time_ns, v, w):
    """Return a TwistStamped."""
    message = TwistStamped(twist=twist(v, w))
    set_stamp(message, time_ns)
    return message
