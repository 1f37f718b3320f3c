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

"""Calibration as its user does it: drive, measure, calibrate, load what it wrote, drive again."""

import math
import os
import re
import signal

from builtin_interfaces.msg import Time
from diffdrive_kinematics.core.kinematics import (
    advance, Pose, twist_from_wheel_rates, WheelGeometry)
from diffdrive_kinematics.core.odometry import WheelSample
from diffdrive_kinematics.ros.parameters.package_share import share_directory
from diffdrive_kinematics.tools.collection import Collection
from geometry_msgs.msg import Pose as PoseMsg
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from support.graph import clock_at, JOINTS, KHEPERA, put, set_stamp, wheel_motion
from support.recorded import RADIUS, RUNS, SEPARATION, TICKS_PER_TURN

SIDE = 12.0 * KHEPERA['wheel_separation']
ROBOT = f"""
/**:
  ros__parameters:
    wheel_radius: {KHEPERA['wheel_radius']}
    wheel_separation: {KHEPERA['wheel_separation']}
    clock_step: 0.02
    real_time_factor: 0.0
    enable_odom_tf: false
/**/diffdrive_sim:
  ros__parameters:
    nodes: [command_sequence, diff_drive_controller, wheel_noise, simulated_base,
            'simulated_base:ground_truth']
/**/command_sequence:
  ros__parameters: {{wait_for_topics: [odom, ground_truth], square_side: {SIDE},
                    square_speed: 0.3, square_yaw_rate: 1.0}}
"""
TRUE = """
/**/wheel_noise:
  ros__parameters: {left_bias: -0.005, right_bias: 0.00495}
/**/ground_truth:
  ros__parameters: {wheel_separation_multiplier: 1.02, wheel_motion_topic: noisy_wheel_rates,
                    odom_topic: ground_truth, odom_frame_id: map, joint_states_topic: ''}
"""
HEADER = 'clockwise,true_x,true_y,odom_x,odom_y\n'
GEOMETRY = '--ros-args -p wheel_radius:=0.021 -p wheel_separation:=0.0885'.split()


def end_positions(report):
    """Return (true x, true y, odometry's x, y) of the table that a simulation ends with."""
    rows = {role: re.search(rf'^{role} \(\S+\) +(\S+) +(\S+)', report, re.M).groups()
            for role in ('belief', 'truth')}
    return [float(value) for role in ('truth', 'belief') for value in rows[role]]


@pytest.fixture
def ran(here):
    """Return what runs an executable that ends well, with settings, and returns its output."""
    def run(name, *settings, files=(), geometry=GEOMETRY):
        done = here(name, [
            *geometry, *(part for file in files for part in ('--params-file', str(file))),
            *(part for each in settings for part in ('-p', each))])
        assert done.wait() == 0, done.output
        return done.output

    return run


def square(ran, clockwise, *settings, files):
    """Drive the square one way round; return the end positions, and their row of the CSV."""
    end = end_positions(ran(
        'diffdrive_sim', f'command_sequence:square_clockwise:={"true" if clockwise else "false"}',
        *settings, files=files, geometry=['--ros-args']))
    return end, ','.join(map(str, [clockwise, *end])) + '\n'


def drive_squares(ran, *files):
    """Drive the square both ways; return the runs as CSV, and the largest error [m]."""
    ends, rows = zip(*(square(ran, clockwise, files=files) for clockwise in (1, 0)))
    # without slip a second run is the same
    return HEADER + ''.join(2 * row for row in rows), max(
        math.dist(end[:2], end[2:]) for end in ends)


@pytest.mark.ros
@pytest.mark.slow
def test_two_passes_of_umbmark_leave_a_fiftieth_of_the_error(ran, tmp_path):
    robot, true = tmp_path / 'robot.yaml', tmp_path / 'true.yaml'
    robot.write_text(ROBOT)
    true.write_text(TRUE)
    errors, found = [], []
    for number in range(3):
        runs, largest = drive_squares(ran, robot, *found[-1:], true)
        errors.append(largest)
        measured, written = tmp_path / f'runs{number}.csv', tmp_path / f'found{number}.yaml'
        measured.write_text(runs)
        ran('calibrate', f'square_runs:={measured}', f'square_side:={SIDE}', f'output:={written}',
            files=found[-1:])
        found.append(written)
        for_all = written.read_text().split('/**/')[0]  # runs that do not scatter say no slip
        assert 'wheel_radius' in for_all and 'slip_variance' not in for_all
    assert errors[0] > 50.0 * errors[2], errors
    simulated = tmp_path / 'simulated.yaml'  # a robot that calibration alone describes
    simulated.write_text(TRUE.split('/**/ground_truth')[0].replace('-0.005', '0.0').replace(
        '0.00495', '0.0') + '/**/ground_truth' + TRUE.split('/**/ground_truth')[1].replace(
        'wheel_separation_multiplier: 1.02, ', ''))
    _, left = drive_squares(ran, robot, simulated, found[1])
    assert left < errors[0] / 50.0


@pytest.mark.ros
@pytest.mark.slow
def test_the_shipped_squares_are_calibrated_to_the_robot_that_they_ship_with(ran, tmp_path):
    config, lines = share_directory() / 'config', HEADER
    for clockwise in (1, 0):
        for seed in (1, 2, 3):
            end, row = square(ran, clockwise, f'wheel_noise:seed:={seed}', files=[
                config / 'squares.yaml', config / 'true.yaml'])
            assert end[2:] == pytest.approx([0.0, 0.0], abs=1e-3)  # it believes to be back
            lines += row
    runs, written = tmp_path / 'runs.csv', tmp_path / 'found.yaml'
    runs.write_text(lines)
    output = ran('calibrate', f'square_runs:={runs}', 'square_side:=1.0', f'output:={written}')
    for name, truth in (('E_d', 1.002 / 0.998), ('E_b', 1.01)):
        value, error = map(float, re.search(
            rf'^{name} \(.*\) +(\S+) +(\S+)$', output, re.M).groups())
        assert abs(value - truth) < 2.776 * error, output  # Student's t of 95 %


@pytest.mark.parametrize('rows, words', [
    ('1,0.1,0,0,0\n' * 2, 'counterclockwise'),
    ('1,0.1,0,0,0\n0,0.1,0,0,0\n', 'expected at least 2'),
    ('1,0.1,0,0,0\n' * 2 + '0,nan,0,0,0\n' * 2, 'nan'),
    ('1,0.1,x,0,0\n', 'row 1'), ('2,0.1,0.0,0,0\n', 'clockwise is 2.0'), ('', 'no rows'),
    ('1,9,9,0,0\n' * 2 + '0,9,9,0,0\n' * 2, 'too large')])
@pytest.mark.ros
def test_runs_that_allow_no_calibration_are_one_line_and_status_2(refused, tmp_path, rows, words):
    runs = tmp_path / 'runs.csv'
    runs.write_text(HEADER + rows)
    refused(words, f'square_runs:={runs}', 'square_side:=1.0')


@pytest.mark.ros
def test_runs_and_a_side_in_millimetres_are_refused(refused, tmp_path):
    runs = tmp_path / 'runs.csv'
    runs.write_text(HEADER + '1,-31,-30,1,0\n1,-26,-34,0,1\n0,-12,12,0,0\n0,-10,17,1,0\n')
    refused('square_side is 1000.0, expected the side [m]', f'square_runs:={runs}',
            'square_side:=1000.0')


@pytest.fixture
def refused(here, tmp_path):
    """Return what sees ``calibrate`` refuse settings in one line, and write nothing."""
    def see(words, *settings):
        before = sorted(tmp_path.iterdir())
        output = [] if any(each.startswith('output:=') for each in settings) else [
            f'output:={tmp_path / "found.yaml"}']
        calibrate = here('calibrate', [
            *GEOMETRY, *(part for each in (*settings, *output) for part in ('-p', each))])
        said = calibrate.output
        assert calibrate.wait() == 2 and words in said, said
        assert len(said.strip().splitlines()) == 1, said
        assert sorted(tmp_path.iterdir()) == before

    return see


@pytest.mark.ros
def test_a_file_that_exists_and_a_directory_that_does_not_are_refused(refused, ran, tmp_path):
    runs = tmp_path / 'runs.csv'
    runs.write_text('clockwise, true_x, true_y, odom_x, odom_y\n'  # as people type it
                    + '1, -0.03, -0.03, 0, 0\n' * 2 + '0, -0.01, 0.01, 0, 0\n' * 2)
    runs_of_it = f'square_runs:={runs}', 'square_side:=1.0'
    refused('which exists', *runs_of_it, f'output:={runs}')
    refused('directory', *runs_of_it, f'output:={tmp_path / "no" / "found.yaml"}')
    refused('directory', *runs_of_it, f'output:={runs / "found.yaml"}')
    refused('directory', *runs_of_it, f'output:={tmp_path}')
    refused('picture is', *runs_of_it, f'picture:={tmp_path / "no" / "found.png"}')
    refused('another file than output', *runs_of_it, *(
        f'{name}:={tmp_path / "found.png"}' for name in ('output', 'picture')))
    assert runs.read_text().startswith('clockwise')
    ran('calibrate', *runs_of_it, f'output:={runs}', 'overwrite:=true')
    assert 'left_bias' in runs.read_text()


TRUTH = {'left_wheel_radius_multiplier': 0.99, 'right_wheel_radius_multiplier': 1.01,
         'wheel_separation_multiplier': 1.03}
RATE = 20.0


def drive_samples(seconds, seed=3):
    """Yield (time, wheel angles, reference pose) of a robot with the wheels of TRUTH."""
    generator = np.random.default_rng(seed)
    left, right, separation = (
        KHEPERA['wheel_radius'] * TRUTH['left_wheel_radius_multiplier'],
        KHEPERA['wheel_radius'] * TRUTH['right_wheel_radius_multiplier'],
        KHEPERA['wheel_separation'] * TRUTH['wheel_separation_multiplier'])
    pose, angles = Pose(0.0, 0.0, 0.0), np.zeros(2)
    for number in range(round(seconds * RATE)):
        time = number / RATE
        noise = generator.normal(0.0, [5e-4, 5e-4, 1e-3])
        yield time, angles, Pose(*(np.array(pose) + noise))
        rates = np.array([7.0 + 3.0 * math.sin(0.9 * time), 7.0 + 3.0 * math.cos(0.7 * time)])
        angles = angles + rates / RATE
        d_left, d_right = rates / RATE * [left, right]
        pose = advance(pose, 0.5 * (d_left + d_right), (d_right - d_left) / separation)


def assert_found(written, rel=3e-3, node='wheel_odometry', truth=TRUTH, of=''):
    """Compare what a file says of a node's wheels."""
    text = written.read_text()
    section = text[text.index(f'/**/{node}:'):]
    found = {name: float(re.search(rf'{name}: (\S+)', section)[1]) for name in truth}
    assert found == pytest.approx(truth, rel=rel), of


@pytest.fixture
def collecting(graph, tmp_path):
    """Return what starts a calibration by topics; it returns the process and its file."""
    def start(**settings):
        written = tmp_path / 'found.yaml'
        return graph.start('calibrate', {
            **KHEPERA, 'output': str(written), 'reference_type': 'pose',
            'reference_topic': 'tracker', **settings}), written

    return start


def live_drive(graph, kind):
    """Return what publishes a drive from a time [ns] on, once somebody listens."""
    wheels, tracker = graph.publisher(JointState, 'joint_states'), graph.publisher(kind, 'tracker')

    def drive(start_ns):
        for time, (left, right), pose in drive_samples(40.0):
            stamp_ns, seen = start_ns + round(time * 1e9), kind()
            set_stamp(seen, stamp_ns)
            put(seen.pose.pose if kind is Odometry else seen.pose, *pose)
            wheels.publish(wheel_motion(stamp_ns, [right, left], names=JOINTS[::-1]))
            tracker.publish(seen)
            graph.executor.spin_once(timeout_sec=0.002)

    return drive


@pytest.mark.parametrize('reference_type, use_sim_time', [('odometry', False), ('pose', True)])
def test_live_topics_are_collected_until_finish_is_called(
        graph, collecting, reference_type, use_sim_time):
    calibrate, written = collecting(reference_type=reference_type, use_sim_time=use_sim_time)
    kind = Odometry if reference_type == 'odometry' else PoseStamped
    drive = live_drive(graph, kind)
    too_early = graph.call(Trigger, 'calibrate/finish', Trigger.Request())
    assert not too_early.success
    assert 'expected some' in too_early.message and 'still collecting' in too_early.message
    start = graph.now_ns()
    if use_sim_time:
        set_time = graph.publisher(Clock, '/clock').publish
        set_time(clock_at(start))
    drive(start)
    if use_sim_time:  # it passes once, and stands still from there on
        set_time(clock_at(start + 40 * 10**9))
    graph.wait_for(lambda: 'deg turned' in calibrate.output, 'a line of what there is')
    answer = graph.call(Trigger, 'calibrate/finish', Trigger.Request())
    assert answer.success, answer.message
    assert answer.message == f'wrote {written}'
    again = graph.call(Trigger, 'calibrate/finish', Trigger.Request())
    assert (again.success, again.message) == (True, answer.message)
    assert (calibrate.stop() if reference_type == 'odometry' else calibrate.wait()) == 0
    assert 'nothing is written' not in calibrate.output
    assert calibrate.output.count('wrote') == 1
    later = calibrate.output.partition(f'wrote {written}')[2].split('\n')
    assert not [  # silent from there on, but for a clock that stands while a process is held up
        line for line in later if line.strip() and '/clock stands' not in line]
    assert 'std. error' in calibrate.output
    text = written.read_text()
    assert text.index('/**:') < text.index('/**/')
    for node in ('diff_drive_controller', 'wheel_odometry', 'simulated_base', 'calibrate'):
        assert_found(written, node=node)
    assert float(re.search(r'right_bias: (\S+)', text)[1]) == pytest.approx(0.01, abs=3e-3)


@pytest.mark.parametrize('sources', [('a', 'b'), ('', '')], ids=['simulation', 'bag'])
def test_a_run_whose_time_begins_anew_is_not_laid_beside_the_reference_of_the_one_before(sources):
    collection = Collection()
    for run, source in enumerate(sources):
        for number in range(100 - 40 * run):
            stamp_ns = 10**9 + number * 10**8
            collection.add_wheels(WheelSample(stamp_ns, None, (1.0, 1.0), source=source))
            pose = PoseMsg()
            pose.position.x = 10.0 * run + number
            collection.add_reference(
                Time(sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9), pose)
    first, second = collection.drives()
    assert first.reference[0, 0] == 0.0 and len(first.reference) == 100
    assert second.reference[0, 0] == 10.0 and len(second.reference) == 60
    assert '160 samples of the wheels, 160 of the reference' in collection.summary(
        WheelGeometry(0.1, 0.05))


def test_wheels_and_a_reference_of_different_clocks_are_named_as_such():
    collection = Collection()
    for number in range(1, 10):
        collection.add_wheels(WheelSample(number * 10**9, None, (1.0, 1.0)))
        collection.add_reference(Time(sec=5000 + number), PoseMsg())
    with pytest.raises(ValueError, match='1.000 to 9.000 s .* 5001.000 to 5009.000 s'):
        collection.drives()


def test_a_reference_that_is_published_as_sensor_data_is_heard(graph, collecting):
    calibrate, _ = collecting()
    graph.wait_for(lambda: 'collecting' in calibrate.output, 'the start')
    tracker = graph.node.create_publisher(PoseStamped, 'tracker', qos_profile_sensor_data)

    def heard():
        seen = PoseStamped()
        set_stamp(seen, graph.now_ns())
        tracker.publish(seen)
        return re.search('[1-9][0-9]* of the reference', calibrate.output)
    graph.wait_for(heard, 'a line that counts the reference')


def test_a_collection_that_is_interrupted_writes_nothing(graph, tmp_path):
    calibrate = graph.start('calibrate', {**KHEPERA, 'output': str(tmp_path / 'found.yaml')})
    graph.wait_for(lambda: "nobody publishes '/joint_states'; nobody publishes '/ground_truth'"
                   in calibrate.output, 'the line that says why nothing comes')
    assert calibrate.stop() == 0
    assert 'no wheel motion has come so far' in calibrate.output
    assert 'nothing is written' in calibrate.output
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM], ids=lambda each: each.name)
def test_ctrl_c_finishes_a_live_calibration_and_the_end_of_a_system_does_not(
        graph, collecting, number):
    calibrate, written = collecting()
    live_drive(graph, PoseStamped)(graph.now_ns())
    graph.wait_for(lambda: 'deg turned' in calibrate.output, 'a line of what there is')
    assert calibrate.stop(number) == 0
    if number == signal.SIGTERM:
        assert 'nothing is written' in calibrate.output and not written.exists()
        return
    assert calibrate.output.rstrip().endswith(f'wrote {written}')
    assert_found(written)


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_calibration_that_waits_for_a_pipe_ends_on_a_signal_and_writes_nothing(
        graph, tmp_path, number):
    pipe, written = tmp_path / 'drive.csv', tmp_path / 'found.yaml'
    os.mkfifo(pipe)
    calibrate = graph.start('calibrate', args=[
        *GEOMETRY, '-p', f'recordings:=[{pipe}]', '-p', f'output:={written}'])

    def opened():
        try:
            return os.open(pipe, os.O_WRONLY | os.O_NONBLOCK)
        except OSError:  # nobody reads yet
            return None

    end = graph.wait_for(opened, 'somebody who reads')
    try:
        os.write(end, f'{HEADER_OF_POSITIONS},x,y,yaw\n0,0,0,0,0,0\n'.encode())
        assert calibrate.stop(number) == 128 + number
    finally:
        os.close(end)
    assert calibrate.output.strip() == 'interrupted: nothing is written'
    assert not written.exists()


def files_of(directory, header, rows, poses):
    """Write a recording and its reference; return the settings that name them."""
    recording, reference = directory / 'drive.csv', directory / 'poses.csv'
    recording.write_text('\n'.join([header, *(','.join(map(str, row)) for row in rows)]) + '\n')
    reference.write_text('\n'.join(
        ['time_sec,x,y,yaw', *(','.join(map(str, pose)) for pose in poses)]) + '\n')
    return f'recordings:=[{recording}]', f'references:=[{reference}]'


@pytest.mark.ros
@pytest.mark.slow
def test_files_of_every_kind_of_motion_find_the_wheels(ran, tmp_path):
    samples = list(drive_samples(60.0))
    times = [time for time, _, _ in samples]
    angles = np.array([angle for _, angle, _ in samples])
    poses = [(time, *pose) for time, _, pose in samples]
    rates = np.vstack([np.diff(angles, axis=0) * RATE, np.zeros(2)])
    twists = np.stack(twist_from_wheel_rates(
        WheelGeometry(KHEPERA['wheel_separation'], KHEPERA['wheel_radius']), *rates.T), axis=1)
    for header, columns, more in (
            ('time_sec,left_position,right_position', angles, ()),
            ('time_sec,left_rate,right_rate', rates, ()),
            ('time_sec,linear_x,angular_z', twists, ()),
            ('time_sec,left_ticks,right_ticks', angles * 500.0,
             (f'encoder_resolution:={500.0 * math.tau}',)),
            ('time_sec,left_ticks,right_ticks', angles * 500.0,
             (f'encoder_resolution:={20.0 * math.tau}', 'gear_ratio:=25.0'))):
        written = tmp_path / 'found.yaml'
        settings = files_of(
            tmp_path, header, [(time, *row) for time, row in zip(times, columns)], poses)
        ran('calibrate', *settings, *more, f'output:={written}', 'overwrite:=true')
        assert_found(written, rel=2e-3, of=header)


@pytest.mark.ros
def test_of_rows_with_one_stamp_the_last_wins_and_the_table_counts_them(ran, tmp_path):
    samples = list(drive_samples(40.0))
    rows = [(time, *angles) for time, angles, _ in samples]
    rows.insert(200, (rows[200][0], 1e3, -1e3))
    settings = files_of(tmp_path, 'time_sec,left_position,right_position', rows,
                        [(time, *pose) for time, _, pose in samples])
    written = tmp_path / 'found.yaml'
    assert '1 rows were replaced' in ran('calibrate', *settings, f'output:={written}')
    assert_found(written)


STRAIGHT = [(0.1 * n, 0.5 * n, 0.5 * n) for n in range(300)]
BESIDE = [(0.1 * n, 0.0105 * n, 0.0, 0.0) for n in range(300)]
HEADER_OF_POSITIONS = 'time_sec,left_position,right_position'


@pytest.mark.parametrize('header, rows, poses, words', [
    (HEADER_OF_POSITIONS, STRAIGHT, BESIDE, 'wheel_separation_multiplier'),
    (HEADER_OF_POSITIONS, STRAIGHT[:50] + STRAIGHT[40:], BESIDE, 'do not fall'),
    (HEADER_OF_POSITIONS, [(0.0, math.nan, 0.0), *STRAIGHT[1:]], BESIDE, 'row 1'),
    (HEADER_OF_POSITIONS, STRAIGHT, [*BESIDE[:7], (0.7, math.inf, 0.0, 0.0)], 'row 8'),
    (HEADER_OF_POSITIONS, [], BESIDE, '0 rows'), ('', [], BESIDE, 'columns'),
    (HEADER_OF_POSITIONS, STRAIGHT, [], '0 rows'),
    ('time_sec,left_ticks,right_ticks', STRAIGHT, BESIDE, 'encoder_resolution'),
    ('time_sec,speed', [(0.0, 1.0)], BESIDE, 'one kind of motion')],
    ids=['straight', 'unsorted', 'nan', 'inf', 'empty', 'nothing', 'no_poses', 'ticks', 'columns'])
@pytest.mark.ros
def test_drives_that_allow_no_calibration_are_one_line_and_status_2(
        refused, tmp_path, header, rows, poses, words):
    refused(words, *files_of(tmp_path, header, rows, poses))


@pytest.mark.ros
@pytest.mark.slow
def test_a_recorded_robot_is_calibrated_and_its_picture_drawn(ran, tmp_path):
    pytest.importorskip('matplotlib')
    written, picture = tmp_path / 'found.yaml', tmp_path / 'found.svg'
    ran('calibrate', f'wheel_radius:={RADIUS}', f'wheel_separation:={SEPARATION}',
        f'encoder_resolution:={TICKS_PER_TURN}', 'tick_increments:=true', f'output:={written}',
        f"recordings:=[{', '.join(map(str, RUNS))}]", f'picture:={picture}',
        geometry=['--ros-args'])
    assert picture.read_bytes().startswith(b'<?xml')
    assert_found(written, 0.003, truth={'wheel_separation_multiplier': 1.006})
