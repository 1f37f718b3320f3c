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

"""The controller in this process, on a clock that is set: what it tells, and with which stamps."""

from types import SimpleNamespace

from diffdrive_kinematics.nodes.diff_drive_controller import DiffDriveController
from diffdrive_kinematics.ros.runtime import clocks, runtime
from diffdrive_kinematics.ros.runtime.clocks import SteadyTimers, SteppedClock
import pytest
import rclpy
from rclpy.clock_type import ClockType
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.time import Time
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool
from support.domains import own_domain
from support.graph import twist, twist_stamped

S = 10**9
STEP = S // 100
SPEED = 0.2  # [m/s]
RAMPS = {'linear.x.max_acceleration': 0.5}


class WallClock(SteadyTimers):
    """Real time, as far as the controller knows: a steady clock and one that can be set."""

    def __init__(self, patch):
        self._steady_ns, self.ahead_ns = 5 * S, 10**6 * S
        patch.setattr(clocks.time, 'monotonic_ns', lambda: self._steady_ns)
        patch.setattr(clocks.time, 'monotonic', lambda: self._steady_ns / S)
        patch.setattr(clocks.time, 'time_ns', lambda: self._steady_ns + self.ahead_ns)
        patch.setattr(
            runtime, 'time_of', lambda _: lambda: self._steady_ns + self.ahead_ns)
        super().__init__()

    def advance_by(self, time_ns):
        self._steady_ns += time_ns


class SlowClock(SteadyTimers):
    """A simulated clock that is told rarely, by a slow simulator, or stands."""

    EVERY_NS, BY_NS = 33 * STEP, S // 10

    def __init__(self, patch):
        self._steady_ns, self._simulated_ns, self.node, self.stands = 5 * S, 100 * S, None, False
        patch.setattr(clocks.time, 'monotonic_ns', lambda: self._steady_ns)
        patch.setattr(clocks.time, 'monotonic', lambda: self._steady_ns / S)
        super().__init__()
        self._tell_at_ns = 0

    def now_ns(self):
        return self._steady_ns

    def advance_by(self, time_ns):
        self._steady_ns += time_ns
        if self._steady_ns >= self._tell_at_ns and not self.stands:
            self._tell_at_ns = self._steady_ns + self.EVERY_NS
            self._simulated_ns += self.BY_NS
            self.node.runtime.clock.set_ros_time_override(
                Time(nanoseconds=self._simulated_ns, clock_type=ClockType.ROS_TIME))
            self.node._tick()


class SetClock(SteppedClock):
    """Time that is stepped."""

    def __init__(self, _):
        super().__init__()
        self.advance_to(100 * S)

    def advance_by(self, time_ns):
        self.advance_to(self.now_ns() + time_ns)


class Robot:
    """A controller whose time goes on when it is told to."""

    def __init__(self, patch, clock=SetClock, **parameters):
        given = {'wheel_radius': 0.021, 'wheel_separation': 0.0885, **parameters}
        rclpy.init(args=['--ros-args', *(
            argument for name, value in given.items() for argument in ('-p', f'{name}:={value}'))])
        self.clock = clock(patch)
        self.node = DiffDriveController(**{
            'stepped' if clock is SetClock else 'timers': self.clock})
        self.clock.node = self.node
        self.told = []
        self.node._out.rates_publisher.publish = lambda data: self.told.append(
            deserialize_message(data, JointState))

    def command(self, v, stamp_ns=None):
        """Give a command, which nobody hears before there is a subscription."""
        if not any(each.topic_name == '/cmd_vel' for each in self.node.subscriptions):
            return
        self.node._on_command(serialize_message(
            twist(v, 0.0) if stamp_ns is None else twist_stamped(stamp_ns, v, 0.0)))

    def configure(self, **parameters):
        results = self.node.set_parameters([
            Parameter(name.replace('__', '.'), value=value) for name, value in parameters.items()])
        assert all(result.successful for result in results), results

    def wait(self, seconds, command=None, then=None):
        """Let time pass, with a command in each step; ``then`` is the speed [m/s] after it."""
        for _ in range(round(seconds * S / STEP)):
            self.clock.advance_by(STEP)
            if command is not None:
                self.command(command)
            for timer in self.clock.due():
                self.clock.fire(timer)
        assert then is None or self.speed() == (then and pytest.approx(then))

    def speeds(self, begin=0):
        return [message.velocity[0] * 0.021 for message in self.told[begin:]]

    def speed(self):
        return self.speeds(-1)[0]

    def latest_ns(self):
        return max(
            message.header.stamp.sec * S + message.header.stamp.nanosec for message in self.told)


@pytest.fixture
def robot(monkeypatch):
    robots = []

    def make(*clock, **parameters):
        robots.append(Robot(monkeypatch, *clock, **parameters))
        return robots[-1]

    with own_domain():
        yield make
        for each in robots:
            each.node.destroy_node()
        rclpy.try_shutdown()


@pytest.mark.parametrize('timeout', [0.0, 20.0])
@pytest.mark.parametrize('limits', [{}, RAMPS], ids=['', 'ramps'])
def test_a_shorter_timeout_ends_the_live_command_in_time_and_what_follows_is_obeyed(
        robot, timeout, limits):
    driven = robot(cmd_vel_timeout=timeout, **limits)
    driven.wait(1.0, SPEED, then=SPEED)
    driven.configure(cmd_vel_timeout=0.5)
    driven.wait(0.45, then=SPEED)
    driven.wait(1.0)
    assert driven.speed() == 0.0 and driven.latest_ns() <= driven.clock.now_ns()
    driven.wait(1.0, -SPEED, then=-SPEED)
    driven.wait(1.0, 0.0)
    assert driven.speed() == 0.0 and driven.latest_ns() <= driven.clock.now_ns()


def test_another_parameter_that_is_set_does_not_put_the_timeout_off(robot):
    driven = robot(publish_rate=0.01)
    driven.wait(0.1, SPEED)
    driven.wait(0.4)
    driven.configure(max_wheel_rate=100.0)
    driven.wait(0.2, then=0.0)


@pytest.mark.parametrize('step', [-S // 50, -S * 3 // 10, -S * 9 // 10, -3600 * S])
@pytest.mark.parametrize('limits', [{}, {'linear.x.max_acceleration': 2.0}], ids=['', 'ramps'])
def test_a_wall_clock_that_is_set_back_does_not_put_off_the_end_of_a_command(robot, step, limits):
    driven = robot(WallClock, **limits)
    driven.wait(1.0, SPEED, then=SPEED)
    driven.clock.ahead_ns += step
    driven.wait(0.45, then=SPEED)
    driven.wait(0.1 + (0.12 if limits else 0.0), then=0.0)


def test_a_wall_clock_that_is_set_back_does_not_put_off_a_stop_in_mid_ramp(robot):
    driven = robot(WallClock, **RAMPS)
    driven.wait(0.2, SPEED)
    driven.clock.ahead_ns -= S * 9 // 10
    driven.wait(0.25, 0.0, then=0.0)


@pytest.mark.parametrize('clock', [SetClock, WallClock])
def test_a_ramp_steps_at_its_own_rate_however_rarely_the_rates_are_repeated(robot, clock):
    driven = robot(clock, publish_rate=0.01, cmd_vel_timeout=0.3, **RAMPS)
    driven.command(SPEED)
    driven.wait(0.29)
    up = driven.speeds()
    assert up == pytest.approx([0.005 * (k + 1) for k in range(len(up))]) and len(up) == 29
    driven.wait(0.4)
    assert driven.speed() == 0.0, 'the end of a command does not wait for a repeat'
    down = driven.speeds(30)
    assert down == pytest.approx([0.145 - 0.005 * k for k in range(len(down))])


@pytest.mark.parametrize('clock', [SetClock, WallClock])
def test_when_a_ramp_is_over_its_timer_rests(robot, clock):
    driven = robot(clock, publish_rate=0.01, cmd_vel_timeout=0.0, **RAMPS)
    timer = driven.node._step_timer._timer
    for command in (SPEED, 0.1, 0.0):
        driven.wait(0.1, command)
        assert timer.next_ns - driven.clock.now_ns() <= STEP
        driven.wait(0.5, command)
        assert timer.next_ns - driven.clock.now_ns() > 1000 * S
    driven.wait(0.1, SPEED)
    driven.node._halt()
    driven.wait(0.1)
    assert timer.next_ns - driven.clock.now_ns() > 1000 * S and driven.speed() == 0.0


@pytest.mark.parametrize('step', [-3600 * S, -S * 9 // 10, 3600 * S])
def test_a_ramp_goes_on_at_its_pace_when_the_wall_clock_is_set(robot, step):
    driven = robot(WallClock, publish_rate=0.01, cmd_vel_timeout=0.0, **RAMPS)
    driven.wait(0.2, SPEED)
    driven.clock.ahead_ns += step
    driven.wait(0.1, SPEED)
    assert driven.speed() == pytest.approx(0.15, abs=0.006)
    driven.wait(0.2, SPEED, then=SPEED)


def test_another_update_rate_holds_in_mid_ramp(robot):
    driven = robot(publish_rate=0.01, cmd_vel_timeout=0.0, **RAMPS)
    driven.wait(0.1, SPEED)
    driven.configure(update_rate=20.0)
    told = len(driven.told)
    driven.wait(0.2)
    steps = driven.speeds(told - 1)
    assert [b - a for a, b in zip(steps, steps[1:])] == pytest.approx([0.5 / 20.0] * 4)


@pytest.mark.parametrize('step', [-S * 3 // 10, -S * 8 // 10])
def test_stamped_commands_are_obeyed_at_once_when_the_wall_clock_was_set_back(robot, step):
    driven = robot(WallClock, enable_stamped_cmd_vel=True)
    driven.wait(0.1)
    driven.command(SPEED, clocks.time.time_ns())
    driven.clock.ahead_ns += step
    driven.wait(0.01)
    driven.command(2.0 * SPEED, clocks.time.time_ns())
    assert driven.speed() == pytest.approx(2.0 * SPEED)
    driven.wait(0.01)
    driven.command(0.0, clocks.time.time_ns())
    assert driven.speed() == 0.0


def test_a_simulated_clock_that_is_told_rarely_does_not_stand(robot):
    driven = robot(SlowClock, use_sim_time=True, **RAMPS)
    driven.wait(8.0, 2.0 * SPEED, then=2.0 * SPEED)
    begun = len(driven.told)
    driven.wait(6.0, SPEED)
    speeds = driven.speeds(begun)
    assert speeds[-1] == pytest.approx(SPEED) and min(speeds) >= SPEED - 1e-9
    assert max(a - b for a, b in zip(speeds, speeds[1:])) <= 0.5 / 50.0 + 1e-9


def test_a_simulated_clock_that_was_told_rarely_and_stands_brings_the_wheels_to_rest(robot):
    driven = robot(SlowClock, use_sim_time=True, cmd_vel_timeout=0.0, **RAMPS)
    driven.wait(6.0, SPEED)
    driven.clock.stands = True
    driven.wait(1.5, 0.1)
    assert driven.speed() <= 0.1
    driven.wait(0.1, 0.0, then=0.0)
    told = len(driven.told)
    driven.wait(1.0, 0.0)
    assert len(driven.told) > told + 5 and driven.speed() == 0.0  # said again


def test_while_a_clock_stands_wheels_at_rest_keep_the_target(robot):
    driven = robot(SlowClock, use_sim_time=True, cmd_vel_timeout=0.0, max_wheel_rate=10.0,
                   **{'linear.x.max_velocity': 0.0})
    driven.wait(2.0, SPEED)
    driven.clock.stands = True
    driven.wait(2.0, then=0.0)
    driven.configure(linear__x__max_velocity=0.1)
    assert driven.speed() == pytest.approx(0.1)


def test_a_command_from_before_an_emergency_stop_does_not_drive_when_it_is_over(robot):
    driven = robot(enable_stamped_cmd_vel=True, emergency_stop_topic='stop')
    for over in (False, True):  # from before the stop, and from before its end
        driven.wait(0.1)
        before_ns = driven.clock.now_ns()
        driven.wait(0.01)
        driven.node._stop._on_topic(Bool(data=True))
        driven.wait(0.01)
        if over:
            before_ns = driven.clock.now_ns()
            driven.wait(0.01)
        driven.node._stop._on_topic(Bool(data=False))
        driven.wait(0.1)
        driven.command(SPEED, before_ns)
        assert driven.speed() == 0.0
    driven.command(SPEED, driven.clock.now_ns())
    assert driven.speed() == pytest.approx(SPEED)


@pytest.mark.parametrize('limits', [{}, RAMPS], ids=['', 'ramps'])
def test_what_waits_in_the_queue_when_a_stall_ends_is_heard_before_anything_is_ended(
        robot, limits):
    driven = robot(WallClock, **limits)
    driven.wait(1.0, SPEED)
    told, waiting = len(driven.told), [(serialize_message(twist(SPEED, 0.0)), {})]
    driven.node._backlog._taken = lambda: waiting.pop() if waiting else None
    driven.clock.advance_by(2 * S)
    driven.wait(0.1)
    assert not waiting
    speeds = driven.speeds(told)
    assert speeds and speeds == pytest.approx([SPEED] * len(speeds))


def test_no_repeat_after_a_stall_overtakes_commands_that_were_due_in_it(robot):
    driven = robot(
        WallClock, enable_stamped_cmd_vel=True, stamp_tolerance=60.0, cmd_vel_timeout=0.0)
    driven.wait(0.1)
    began_ns = driven.clock.now_ns() + driven.clock.ahead_ns
    driven.command(SPEED, began_ns)
    driven.wait(0.5)
    told = len(driven.told)
    driven.clock.advance_by(2 * S)
    driven.wait(0.05)
    assert not driven.told[told:]
    driven.command(-SPEED, began_ns + S)
    assert driven.latest_ns() == began_ns + S
    driven.wait(0.2)
    assert driven.latest_ns() > began_ns + 2 * S and driven.speed() == pytest.approx(-SPEED)


@pytest.mark.parametrize('in_time', [0, 1, 6])
def test_a_process_that_is_late_again_and_again_repeats_its_rates_all_the_same(robot, in_time):
    driven = robot(
        WallClock, enable_stamped_cmd_vel=True, stamp_tolerance=60.0, cmd_vel_timeout=0.0)
    driven.wait(0.1)
    driven.command(SPEED, driven.clock.now_ns() + driven.clock.ahead_ns)
    told = len(driven.told)
    for _ in range(40):
        driven.clock.advance_by(S // 10)
        driven.wait(STEP / S)
        driven.wait(0.02 * in_time)
    assert len(driven.told) > told + 30


def publishers(robot, durability):
    """Let the controller know of a publisher of its stop, and not yet of what it says."""
    robot.node.get_publishers_info_by_topic = lambda topic: [
        SimpleNamespace(qos_profile=QoSProfile(depth=1, durability=durability))
    ] if topic == '/stop' else []


@pytest.mark.parametrize('latest', [0.5, 4.5])
def test_no_command_is_obeyed_before_what_may_be_latched_on_the_stop_has_come(robot, latest):
    driven = robot(WallClock, emergency_stop_topic='stop')
    publishers(driven, DurabilityPolicy.TRANSIENT_LOCAL)
    driven.wait(latest, SPEED)
    driven.node._stop._on_topic(Bool(data=True))
    driven.wait(10.0, SPEED)
    assert driven.speed() == 0.0 and {driven.speed()} == {*(
        message.velocity[0] for message in driven.told)}
    driven.node._stop._on_topic(Bool(data=False))
    driven.wait(0.1, SPEED, then=SPEED)


@pytest.mark.parametrize('durability, seconds', [
    (DurabilityPolicy.TRANSIENT_LOCAL, 5.0), (DurabilityPolicy.VOLATILE, 1.0)])
def test_a_stop_whose_publisher_says_nothing_holds_the_robot_for_a_moment_only(
        robot, durability, seconds):
    driven = robot(WallClock, emergency_stop_topic='stop')
    publishers(driven, durability)
    driven.wait(seconds - 0.1, SPEED, then=0.0)
    driven.wait(0.2, SPEED, then=SPEED)


def test_neither_a_slow_start_nor_a_stall_shortens_the_time_in_which_a_stop_may_come(robot):
    driven = robot(WallClock, emergency_stop_topic='stop')
    for _ in range(3):
        driven.clock.advance_by(3 * S)
        driven.wait(0.2, SPEED)
    assert driven.speed() == 0.0
    driven.wait(1.0, SPEED, then=SPEED)


def test_a_stop_that_says_it_is_off_lets_the_next_command_through_at_once(robot):
    driven = robot(WallClock, emergency_stop_topic='stop')
    driven.node._stop._on_topic(Bool(data=False))
    driven.wait(0.1, SPEED, then=SPEED)
