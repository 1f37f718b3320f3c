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

"""Whatever a message or a parameter says, nothing leaves a node, and odometry stays finite."""

from collections import Counter
from importlib import import_module
import math
import re

from builtin_interfaces.msg import Time
from diffdrive_kinematics.core.kinematics import advance, Pose
from diffdrive_kinematics.nodes import calibrate, forward_projection
from diffdrive_kinematics.nodes.diffdrive_sim import node_class
from diffdrive_kinematics.ros.parameters.parameter_checks import check_positive_or_nan
from diffdrive_kinematics.ros.parameters.parameter_spec import Kind
from diffdrive_kinematics.ros.parameters.parameters import ConfigurationError, ParameterSet
from diffdrive_kinematics.ros.parameters.tables import TABLES
from diffdrive_kinematics.ros.runtime.rclpy_private import given_overrides
from diffdrive_kinematics.tools.collection import Collection
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, Twist, TwistStamped, Vector3
from hypothesis import given, HealthCheck, Phase, settings, strategies as st
from nav_msgs.msg import Odometry
import pytest
import rclpy
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from std_srvs.srv import Trigger
from support.graph import JOINTS, KHEPERA, odometry_of, twist, wheel_motion
from support.inside import inside, START_NS

BATCH = 40  # messages an example
MESSAGES = 100  # examples of each test: 8 tests, 32,000 messages
NO_NUMBER = re.compile(r'\b(nan|inf)\b', re.IGNORECASE)
NODES = {name: node_class(name) for name in (
    'diff_drive_controller', 'wheel_noise', 'simulated_base', 'forward_projection')}
BUILDERS = {name: import_module(f'diffdrive_kinematics.nodes.{name}').build for name in (
    *NODES, 'command_sequence', 'goal_steering', 'diffdrive_sim')}


def fuzz(examples):
    """Return settings for a number of examples."""
    return settings(
        max_examples=examples, deadline=None, derandomize=True, database=None,
        phases=[Phase.generate],
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


nasty = st.sampled_from([
    math.nan, math.inf, -math.inf, 5e-324, -5e-324, 2.3e-308, 1e308, -1.7976931348623157e308,
    1e-17, -0.0, 0.0, 1.0, -1.0, 1e6, 1e9, 1e12, -1e12, 1.1e12, 2.0**53, math.pi])
numbers = nasty | st.floats(-10.0, 10.0) | st.floats()
stamps = st.builds(
    Time, sec=st.sampled_from([0, 999, 1000, 1001, -1, -2**31, 2**31 - 1]) | st.integers(
        990, 1010), nanosec=st.sampled_from([0, 1, 10**9 - 1, 2**32 - 1]) | st.integers(
        0, 10**9 - 1))
headers = st.builds(Header, stamp=stamps, frame_id=st.sampled_from(['', 'a', 'b', '\U0001f916']))
few = st.lists(numbers, max_size=3) | st.lists(numbers, min_size=2, max_size=2)
names = st.sampled_from([
    JOINTS, JOINTS, JOINTS, JOINTS[::-1], [], JOINTS[:1], ['arm', *JOINTS], JOINTS * 2,
    ['', 'ж\u0301\U0001f916']])
vectors = st.builds(Vector3, x=numbers, y=numbers, z=numbers)
twists = st.builds(Twist, linear=vectors, angular=vectors)
stamped_twists = st.builds(TwistStamped, header=headers, twist=twists)
wheels = st.builds(JointState, header=headers, name=names, velocity=few, position=few)


@st.composite
def odometries(draw):
    message = Odometry(header=draw(headers))
    at, q = message.pose.pose.position, message.pose.pose.orientation
    if draw(st.booleans()):
        at.x, at.y, q.z, q.w = draw(numbers), draw(numbers), 0.6, 0.8
    else:
        at.x, at.y, q.x, q.y, q.z, q.w = (draw(numbers) for _ in range(6))
    return message


@st.composite
def beliefs(draw):
    """Return odometries, most of them in frames that fit a ground truth in ``map``."""
    message = draw(odometries())
    message.header.frame_id = draw(st.sampled_from(['odom', 'odom', 'odom', 'map', '']))
    message.child_frame_id = draw(st.sampled_from(['base_link', 'base_link', 'base_link', '']))
    return message


@st.composite
def places(draw):
    """Return poses with covariance, sane ones more often than chance would have it."""
    message = PoseWithCovarianceStamped(header=draw(headers))
    message.header.frame_id = draw(st.sampled_from(['odom', 'odom', 'map', '']))
    sane = draw(st.booleans())
    coordinates = st.floats(-1e6, 1e6) if sane else numbers
    at, q = message.pose.pose.position, message.pose.pose.orientation
    at.x, at.y, at.z = (draw(coordinates) for _ in range(3))
    q.z, q.w = (0.6, 0.8) if sane else (draw(numbers), draw(numbers))
    for index in draw(st.lists(st.integers(0, 35), max_size=4)):
        message.pose.covariance[index] = draw(numbers)
    return message


values = st.one_of(
    numbers, numbers, st.integers(-2**63, 2**63 - 1), st.integers(-3, 30), st.booleans(),
    st.text(max_size=8), st.sampled_from([
        '', 'travel', 'command', 'gaussian', 'odom', 'cmd_vel', '/', '~', 'a//b', 'a' * 300,
        '{node}', 'ж', '\x00', '.csv', '/dev/null']),
    st.lists(numbers, max_size=7), st.lists(st.integers(-2**63, 2**63 - 1), max_size=7),
    st.lists(st.booleans(), max_size=3), st.binary(max_size=3).map(
        lambda data: [bytes([byte]) for byte in data]),
    st.lists(st.text(max_size=4) | st.sampled_from(
        [*JOINTS, 'simulated_base', 'wheel_noise:a/b']), max_size=4))


texts = st.sampled_from(['', 'travel', 'uniform', 'odom', 'a//b', 'ж']) | st.text(max_size=8)
OF_KIND = {
    Kind.BOOL: st.booleans(), Kind.INTEGER: st.integers(-3, 30) | st.integers(-2**63, 2**63 - 1),
    Kind.DOUBLE: numbers | st.floats(1e-7, 10.0), Kind.STRING: texts,
    Kind.STRINGS: st.lists(texts, max_size=3), Kind.DOUBLES: st.lists(numbers, max_size=7)}


def settings_of(node, writable=False):
    """Return lists of parameters of a node with any values, of their own kind more often."""
    entries = [entry for entry in TABLES[node] if not (writable and entry.read_only)]
    return st.lists(st.sampled_from(entries).flatmap(lambda entry: st.tuples(
        st.just(entry.name), OF_KIND[entry.kind] | OF_KIND[entry.kind] | values)),
        min_size=1, max_size=4).map(lambda pairs: list(dict(pairs).items()))


def assert_sound(node, said):
    """Compare accepted values with what no node could work with."""
    unset = {entry.name for entry in TABLES[node]
             if entry.check is check_positive_or_nan and math.isnan(said.get(entry.name, 0.0))}
    for name in (said.keys() - unset) & {
            'wheel_radius', 'wheel_separation', 'publish_rate', 'horizon'}:
        assert math.isfinite(said[name]) and said[name] > 0.0
    for name in said.keys() & {'left_slip_variance', 'right_slip_variance', 'covariance_floor',
                               'cmd_vel_timeout', 'command_timeout', 'stamp_tolerance'}:
        assert math.isfinite(said[name]) and said[name] >= 0.0
    assert said.get('seed', 0) >= 0 and said.get('samples', 1) >= 1
    assert all(map(math.isfinite, said.get('initial_pose', ())))


def parameter(name, value):
    """Return a parameter as a params file or a service call makes it; None for no such value."""
    kinds = {
        bool: Parameter.Type.BOOL, int: Parameter.Type.INTEGER, float: Parameter.Type.DOUBLE,
        str: Parameter.Type.STRING}
    arrays = {
        bool: Parameter.Type.BOOL_ARRAY, int: Parameter.Type.INTEGER_ARRAY,
        float: Parameter.Type.DOUBLE_ARRAY, str: Parameter.Type.STRING_ARRAY,
        bytes: Parameter.Type.BYTE_ARRAY}
    if isinstance(value, list):
        return Parameter(name, arrays[type(value[0])] if value else Parameter.Type.NOT_SET,
                         value or None)
    return Parameter(name, kinds[type(value)], value)


def assert_finite(message):
    """Compare all that moves a robot or says where it is."""
    if isinstance(message, JointState):
        assert all(map(math.isfinite, [*message.velocity, *message.position]))
    elif isinstance(message, Odometry):
        pose, speed = message.pose.pose, message.twist.twist
        assert all(map(math.isfinite, (
            pose.position.x, pose.position.y, pose.orientation.z, pose.orientation.w,
            speed.linear.x, speed.angular.z)))
        assert all(map(math.isfinite, [*message.pose.covariance, *message.twist.covariance]))
        assert all(variance >= 0.0 for variance in message.pose.covariance[::7])
    for each in getattr(message, 'transforms', ()):
        at, q = each.transform.translation, each.transform.rotation
        assert all(map(math.isfinite, (at.x, at.y, q.z, q.w)))
        assert q.z**2 + q.w**2 == pytest.approx(1.0)
        assert each.header.stamp.nanosec < 10**9
        assert (each.header.frame_id, each.child_frame_id) == ('map', 'odom')


def assert_works(node, batches, change=None, examples=MESSAGES):
    """Feed batches of (topic, message) to one node, with time going on; nothing may come out."""
    overrides = {name: value for name, value in KHEPERA.items()
                 if name in {entry.name for entry in TABLES[node]}}
    slips = {'left_slip_variance': 1e-6, 'right_slip_variance': 1e-6, 'publish_rate': 20.0,
             **({'samples': 3, 'stages': 2, 'slip_distribution': 'uniform'}
                if node == 'forward_projection' else {})}
    overrides.update({name: value for name, value in slips.items()
                      if name in {entry.name for entry in TABLES[node]}})
    overrides.update(change or {})
    with inside(NODES[node], overrides, quiet=True) as held:
        now, fed = {'ns': held.clock.now_ns()}, Counter()

        @fuzz(examples)
        @given(batches)
        def feed(batch):
            for topic, message, step_ns in batch:
                now['ns'] += step_ns
                if abs(now['ns'] - START_NS) > 10 * 10**9:  # stay near the stamps
                    now['ns'] = START_NS
                    held.clock.advance_to(START_NS)
                    for timer in held.clock.timers:
                        timer.reset()
                held.hear(topic, message)
                held.advance_to(now['ns'])
                fed[topic] += 1
                for said in held.said.values():
                    if said:
                        assert_finite(said[-1])  # nodes fill one message again and again
                        fed['said'] += 1
                    said.clear()

        feed()
        assert fed.pop('said') > 100  # or there was nothing to judge
        assert sum(fed.values()) == examples * BATCH
        return held.node.counts


def batches_of(*pairs):
    """Return batches of messages, each with its topic and the time [ns] that follows it."""
    each = st.one_of(*(st.tuples(st.just(topic), messages, st.sampled_from(
        [0, 1, 20_000_000, 60_000_000, 600_000_000, 9_000_000_000, -50_000_000, -5_000_000_000]))
        for topic, messages in pairs))
    return st.lists(each, min_size=BATCH, max_size=BATCH)


@pytest.mark.slow
@pytest.mark.parametrize('stamped', [False, True])
def test_no_command_takes_the_controller_down(stamped):
    counts = assert_works('diff_drive_controller', batches_of(
        ('/cmd_vel', stamped_twists if stamped else twists)), {
            'enable_stamped_cmd_vel': stamped, 'stamp_tolerance': 5.0,
            'publish_limited_velocity': True, 'wheel_commands_topic': 'wheel_commands',
            **({'linear.x.max_acceleration': 1.0, 'angular.z.max_jerk': 5.0} if stamped else {})})
    assert counts['refused'] > 100


@pytest.mark.slow
def test_no_wheel_motion_takes_the_noise_down():
    counts = assert_works(  # it says less than it is told, so it is told more
        'wheel_noise', batches_of(('/wheel_rates', wheels)), examples=2 * MESSAGES)
    assert counts['refused'] > 100


@pytest.mark.slow
def test_no_wheel_motion_takes_the_base_down_and_its_odometry_stays_finite():
    assert assert_works('simulated_base', batches_of(('/wheel_rates', wheels)), {
        'enable_odom_tf': False})['refused'] > 100


@pytest.mark.slow
@pytest.mark.parametrize('encoders', [
    {}, {'encoder_range': 6.28, 'encoder_resolution': 100.0, 'max_encoder_rate': 50.0,
         'left_wheel_inverted': True}], ids=['ideal', 'real'])
def test_no_pose_that_is_set_takes_the_base_down_and_its_odometry_stays_finite(encoders):
    counts = assert_works('simulated_base', batches_of(
        ('/wheel_rates', wheels), ('/set_pose', places())), {
            'enable_odom_tf': False, 'path_topic': 'path', **encoders})
    assert counts['refused'] > 100


@pytest.mark.slow
def test_no_belief_takes_the_ground_truth_down_and_its_transforms_stay_finite():
    counts = assert_works('simulated_base', batches_of(
        ('/wheel_rates', wheels), ('/odom', beliefs())), {
            'enable_odom_tf': False, 'publish_map_odom_tf': True, 'odom_frame_id': 'map',
            'odom_topic': 'ground_truth'})
    assert counts['refused'] > 100


def listening(**shared):
    """Return a calibration that listens to topics."""
    node = calibrate.Calibrate(**shared)
    node.listen()
    return node


def sane_drive(count):
    """Return (wheels, odometry) every 0.2 s of an S with a rest, which can be calibrated."""
    pose, angles = Pose(0.0, 0.0, 0.0), [0.0, 0.0]
    drive = []
    for number in range(count):
        rates = ((0.0, 0.0), (9.0, 14.0), (14.0, 9.0))[3 * number // count]
        time_ns = 990 * 10**9 + number * 200_000_000
        drive.append((wheel_motion(time_ns, angles, rates), odometry_of(time_ns, pose, '')))
        left, right = (0.021 * rate * 0.2 for rate in rates)
        pose = advance(pose, 0.5 * (left + right), (right - left) / 0.0885)
        angles = [angle + rate * 0.2 for angle, rate in zip(angles, rates)]
    return drive


@pytest.mark.slow
@pytest.mark.parametrize('reference', ['odometry', 'pose'])
def test_nothing_that_calibrate_hears_takes_it_down_and_it_answers(tmp_path, reference):
    """Mix nonsense with a drive; most of it has the stamps of the drive, or it was left out."""
    posed = reference == 'pose'
    drive = sane_drive(3 * BATCH)
    with inside(listening, {
            **KHEPERA, 'output': str(tmp_path / 'found.yaml'), 'overwrite': True,
            'reference_type': reference}, quiet=True) as held:
        finish = next(service.callback for service in held.node.services
                      if service.srv_name.endswith('/finish'))
        answers = Counter()

        def hear_reference(message):
            held.hear('/ground_truth', PoseStamped(
                header=message.header, pose=message.pose.pose) if posed else message)

        @fuzz(20)
        @given(st.lists(st.tuples(wheels, odometries(), st.integers(0, 7)), min_size=BATCH,
                        max_size=BATCH), st.integers(1, BATCH))
        def feed(nonsense, heard):
            held.node.collection, held.node.written = Collection(), ''
            for number, (rolled, seen) in enumerate(drive):
                held.hear('/joint_states', rolled)
                hear_reference(seen)
                if number % 3 == 0 and number // 3 < heard:
                    joints, place, how = nonsense[number // 3]
                    if how:
                        joints.header = place.header = rolled.header
                    held.hear('/joint_states', joints)
                    hear_reference(place)
            held.advance_to(held.clock.now_ns() + 2 * 10**9)  # and report the progress
            answer = finish(Trigger.Request(), Trigger.Response())
            assert answer.message
            if answer.success:
                assert not NO_NUMBER.search((tmp_path / 'found.yaml').read_text())
            answers[answer.success] += 1

        feed()
        assert answers[True] and sum(answers.values()) == 20
        assert held.node.counts['refused'] > 100


@pytest.mark.slow
def test_no_odometry_or_wheel_motion_takes_the_projection_down(monkeypatch):
    monkeypatch.setattr(
        forward_projection, '_has_subscribers', lambda publisher: publisher is not None)
    assert assert_works('forward_projection', batches_of(
        ('/wheel_rates', wheels), ('/odom', odometries())))['refused'] > 100


@pytest.mark.slow
@pytest.mark.parametrize('node', sorted(NODES))
def test_no_parameter_at_run_time_takes_a_node_down_or_spoils_its_geometry(node):
    own = {entry.name for entry in TABLES[node]}
    needed = {name: value for name, value in KHEPERA.items() if name in own}
    with inside(NODES[node], needed, quiet=True) as held:
        outcomes = Counter()

        @fuzz(150)
        @given(settings_of(node, writable=True))
        def change(pairs):
            results = held.node.set_parameters([parameter(*pair) for pair in pairs])
            outcomes.update(result.successful for result in results)
            said = held.node.config.values
            assert_sound(node, said)
            assert held.node.get_parameter('wheel_radius').value == said['wheel_radius']
            if node != 'forward_projection':  # which would draw 100,000 poses
                held.advance_to(held.clock.now_ns() + 10_000_000)
            for messages in held.said.values():
                if messages:
                    assert_finite(messages[-1])
                messages.clear()

        change()
    assert outcomes[True] > 20 and outcomes[False] > 20


@pytest.mark.parametrize('node', sorted(BUILDERS))
def test_whatever_the_yaml_says_a_node_starts_or_says_what_is_wrong(node):
    """Declare the parameters as the node does, which is all that reads them."""
    outcomes = Counter()
    with inside(NODES['simulated_base'], KHEPERA):  # for its context
        own = {entry.name: entry for entry in TABLES[node]}
        needed = {'wheel_radius': 0.021, 'wheel_separation': 0.0885, 'commands': [0.1, 0.0, 1.0],
                  'nodes': ['simulated_base']}

        @fuzz(80)
        @given(settings_of(node), st.sampled_from(['alone', 'complete', 'nothing else']))
        def start(pairs, rest):
            given_values = {} if rest == 'nothing else' else dict(pairs)
            if rest != 'alone':
                given_values = {
                    **{name: value for name, value in needed.items() if name in own},
                    **given_values}
            started = rclpy.create_node(
                'fuzzed', enable_rosout=False, start_parameter_services=False,
                parameter_overrides=[
                    parameter(*pair) for pair in given_values.items()])
            try:
                config = ParameterSet(
                    started, TABLES[node], BUILDERS[node], given_overrides(started)).config
                outcomes['started'] += 1
                assert_sound(node, getattr(config, 'values', {}))
                geometry = getattr(config, 'geometry', None)
                assert geometry is None or 0.0 < geometry.separation < math.inf
            except ConfigurationError as error:
                assert 'refuses to start' in str(error)
                outcomes['refused'] += 1
            finally:
                started.destroy_node()

        start()
    assert outcomes['refused'] > 5 and outcomes['started'] > 0


def test_real_processes_survive_a_burst_of_nonsense_over_dds(graph):
    """Compare the same strategies, serialised: the processes answer afterwards and end with 0."""
    controller = graph.start('diff_drive_controller', {**KHEPERA, 'cmd_vel_timeout': 0.0})
    base = graph.start('simulated_base', {
        **KHEPERA, 'enable_odom_tf': False, 'wheel_motion_topic': 'joint_nonsense'})
    noise = graph.start('wheel_noise', {
        'wheel_radius': 0.021, 'input_topic': 'joint_nonsense', 'left_slip_variance': 1e-6})
    rates = graph.collect(JointState, 'wheel_rates')
    odometry = graph.collect(Odometry, 'odom')
    noisy = graph.collect(JointState, 'noisy_wheel_rates')
    commands = graph.publisher(Twist, 'cmd_vel')
    joints = graph.publisher(JointState, 'joint_nonsense', listeners=2)

    @fuzz(40)
    @given(st.lists(twists, min_size=15, max_size=15), st.lists(wheels, min_size=15, max_size=15))
    def burst(asked, rolled):
        for message in asked:
            commands.publish(message)
        for message in rolled:
            joints.publish(message)
        graph.executor.spin_once(timeout_sec=0.0)

    burst()

    def answered():
        commands.publish(twist(0.021, 0.0))
        return rates and list(rates[-1].velocity) == pytest.approx([1.0, 1.0], rel=1e-9)

    graph.wait_for(answered, 'the controller to obey')
    heard = len(odometry), len(noisy)

    def lives_on():
        joints.publish(JointState(name=JOINTS, velocity=[1.0, 1.0]))
        return len(odometry) > heard[0] + 3 and len(noisy) > heard[1] + 3

    graph.wait_for(lives_on, 'base and noise to go on')
    for message in (*rates, *odometry, *noisy):
        assert_finite(message)
    for process in (controller, base, noise):
        assert process.running and 'Traceback' not in process.output
        assert process.stop() == 0, process.output


@pytest.mark.parametrize('sec, nanosec', [(5, 10**9), (2**31 - 1, 0), (-1, 2**32 - 1)])
def test_a_stamp_that_is_none_is_refused_and_the_noise_lives_on(sec, nanosec):
    message = JointState(name=JOINTS, velocity=[1.0, 1.0])
    with inside(NODES['wheel_noise'], {'wheel_radius': 0.021}) as held:
        message.header.stamp = Time(sec=sec, nanosec=nanosec)
        held.hear('/wheel_rates', message)
        assert held.node.counts['refused'] == 1
        message.header.stamp = Time(sec=1000)
        held.hear('/wheel_rates', message)
        assert [list(said.velocity) for said in held.said['/noisy_wheel_rates']] == [[1.0, 1.0]]
