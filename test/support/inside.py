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
Nodes of the package inside the test, on time that the test sets, without an executor.

They are real: rclpy declares their parameters, and their messages go out over DDS.  The test
calls their subscriptions back itself, so a message costs microseconds and its order is certain.
"""

from contextlib import contextmanager
from functools import partial
from importlib import import_module
from inspect import signature
import os
import signal
import sys
import time

from diffdrive_kinematics.ros.runtime.clocks import SteppedClock
from diffdrive_kinematics.ros.runtime.in_flight_messages import InFlightMessages
from diffdrive_kinematics.ros.runtime.running import make_executor, run
from diffdrive_kinematics.ros.runtime.signals import SIGNALS
import rclpy
from rclpy.logging import LoggingSeverity
from rclpy.serialization import serialize_message
from rclpy.signals import SignalHandlerOptions
from support.domains import own_domain
from support.graph import arguments, DEADLINE_S
from support.tf import read

START_NS = 1000 * 10**9


class Inside:
    """One node, its clock, and all that it says, by topic."""

    def __init__(self, make, name=None):
        self.clock = SteppedClock()
        self.clock.advance_to(START_NS)
        shared = {'stepped': self.clock, 'in_flight': InFlightMessages()}
        self.node = make(name, **shared) if name else make(**shared)
        self.said = {}
        self._heard = {
            subscription.topic_name: subscription
            for subscription in self.node.subscriptions}
        for publisher in self.node.publishers:
            self._listen(publisher)

    def _listen(self, publisher):
        said, publish = self.said.setdefault(publisher.topic_name, []), publisher.publish

        def keeping(message):
            said.append(
                read(message, publisher.msg_type)
                if isinstance(message, bytes) else message)
            publish(message)

        publisher.publish = keeping

    def hear(self, topic, message):
        """Give the node a message, as its executor would."""
        subscription = self._heard[topic]
        given = serialize_message(message) if subscription.raw else message
        informed = len(signature(subscription.callback).parameters) == 2
        subscription.callback((given, {}) if informed else given)

    def advance_to(self, time_ns):
        """Set the time, and fire what is due once."""
        self.clock.advance_to(time_ns)
        for timer in self.clock.due():
            self.clock.fire(timer)


@contextmanager
def initialised(parameters=None, args=None):
    """Have rclpy in this process, in a domain of its own."""
    with own_domain() as domain:
        rclpy.init(
            args=arguments(parameters or {}) if args is None else args, domain_id=domain,
            signal_handler_options=SignalHandlerOptions.NO)
        try:
            yield
        finally:
            rclpy.try_shutdown()


@contextmanager
def inside(make, parameters=None, *, name=None, args=None, quiet=False):
    """Yield a node in a context and a domain of its own; a ``quiet`` one logs nothing."""
    with initialised(parameters, args):
        held = Inside(make, name)
        logger = held.node.get_logger()
        try:
            if quiet:
                logger.set_level(LoggingSeverity.FATAL)
            yield held
        finally:
            logger.set_level(LoggingSeverity.UNSET)  # else it is that of all nodes of the name
            held.node.destroy_node()


@contextmanager
def beside(make, parameters, executor='single_threaded'):
    """Yield a node on rclpy's clock and timers, the test's, and what spins both until it holds."""
    with initialised(parameters):
        node, test = make(), rclpy.create_node('test', use_global_arguments=False)
        spinning, deadline = make_executor([node, test], executor), time.monotonic() + DEADLINE_S

        def spin_until(condition):
            while not condition():
                assert time.monotonic() < deadline
                spinning.spin_once(timeout_sec=0.05)

        try:
            yield node, test, spin_until
        finally:
            spinning.shutdown()
            node.destroy_node()
            test.destroy_node()


def status_of(start, args):
    """Start an executable in a domain of its own; return its exit status."""
    handlers = {number: signal.getsignal(number) for number in SIGNALS}
    before, argv = os.environ.get('ROS_DOMAIN_ID'), sys.argv
    try:
        with own_domain() as domain:
            os.environ['ROS_DOMAIN_ID'] = str(domain)
            sys.argv = ['test', *args]  # where nodes look for their params files, too
            return start()
    except SystemExit as ended:
        return ended.code
    finally:
        sys.argv = argv
        os.environ.pop('ROS_DOMAIN_ID', None)
        if before is not None:
            os.environ['ROS_DOMAIN_ID'] = before
        for number, handler in handlers.items():
            signal.signal(number, handler)


class Run:
    """A run of an executable in the process of the test, which has ended."""

    def __init__(self, name, args, capfd):
        module = import_module(f'diffdrive_kinematics.nodes.{name}')
        work = getattr(module, 'work', None)
        capfd.readouterr()
        self._status = status_of(partial(run, work) if work else module.main, args)
        self.output = ''.join(capfd.readouterr())

    def wait(self):
        """Return the exit status."""
        return self._status
