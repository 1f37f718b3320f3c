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

"""What parameters name is what tf2 can take, and a rejected names what the user has written."""

import math

from diffdrive_kinematics.ros.parameters.drive_from_values import axis_limits
from diffdrive_kinematics.ros.parameters.parameters import coerce
from diffdrive_kinematics.ros.parameters.tables import DIFF_DRIVE_CONTROLLER, TABLES
from diffdrive_kinematics.ros.parameters.tables.controller import LIMITS
from diffdrive_kinematics.ros.publishers.tf import frame_prefix
import pytest

FRAMES = [(kind, entry) for kind, table in TABLES.items() for entry in table
          if entry.name.endswith('frame_id')]
NAN = math.nan
AXES = 'linear.x', 'angular.z'
DEFAULTS = {entry.name: entry.default for entry in DIFF_DRIVE_CONTROLLER}


def test_every_node_that_names_a_frame_is_looked_at():
    assert {(kind, entry.name) for kind, entry in FRAMES} >= {
        ('diff_drive_controller', 'base_frame_id'), ('simulated_base', 'odom_frame_id'),
        ('simulated_base', 'base_frame_id'), ('wheel_odometry', 'odom_frame_id'),
        ('command_sequence', 'base_frame_id'), ('robot_description', 'base_frame_id')}


@pytest.mark.parametrize('kind, entry', FRAMES, ids=lambda value: getattr(value, 'name', value))
def test_a_frame_that_tf2_would_not_find_is_refused_with_the_form_that_it_has_there(kind, entry):
    for value, words in (('/odom', "expected 'odom'"), ('//robot1/odom', "expected 'robot1/odom'"),
                         ('', 'is empty'), ('/', 'expected'), ('base link', 'blanks'),
                         ('odom ', 'blanks'), ('\todom', 'blanks'), ('~', "'~'"),
                         ('~/odom', "'~'")):
        with pytest.raises(ValueError) as refused:
            coerce(entry, value)
        assert entry.name in str(refused.value) and words in str(refused.value)
    for value in ('odom', 'robot1/odom', 'base_link', 'Ω'):
        assert coerce(entry, value) == value


@pytest.mark.parametrize('prefix, namespace, expected', [
    ('', '/robot1', 'robot1/'), ('~', '/robot1', 'robot1/'), ('~/', '/robot1', 'robot1/'),
    ('~/left', '/robot1', 'robot1/left/'), ('~', '/', ''), ('', '/', ''), ('~/left', '/', 'left/'),
    ('a', '/robot1', 'a/'), ('/a/', '/robot1', 'a/'), ('/', '/robot1', '')])
def test_a_prefix_is_what_ros2_controllers_makes_of_it(prefix, namespace, expected):
    values = {'tf_frame_prefix_enable': True, 'tf_frame_prefix': prefix}
    assert frame_prefix(values, namespace) == expected


@pytest.mark.parametrize('kind', ['simulated_base', 'wheel_odometry'])
@pytest.mark.parametrize('value, words', [
    ('a b', 'blanks'), (' ', 'blanks'), ('a~', "'~'"), ('~a', "'~'"), ('a/~/b', "'~'")])
def test_a_prefix_that_is_none_is_refused(kind, value, words):
    entry, = (entry for entry in TABLES[kind] if entry.name == 'tf_frame_prefix')
    with pytest.raises(ValueError, match='tf_frame_prefix is .*expected') as refused:
        coerce(entry, value)
    assert words in str(refused.value)


@pytest.mark.parametrize('axis', AXES)
@pytest.mark.parametrize('given', [
    {'min_acceleration': 2.5}, {'min_acceleration': 0.0},
    {'min_acceleration': 2.5, 'max_deceleration': -1.0},
    {'min_acceleration': 2.5, 'max_acceleration': 1.0},
    {'min_acceleration': -1.0, 'max_acceleration': -1.0},
    *({limit: 0.0} for limit in LIMITS if 'celeration' in limit or 'jerk' in limit),
    {'max_velocity': -1.0}, {'min_velocity': 1.0}])
def test_a_limit_is_refused_by_a_name_and_a_value_that_were_set(axis, given):
    values = {**DEFAULTS, **{f'{axis}.{limit}': value for limit, value in given.items()}}
    with pytest.raises(ValueError) as refused:
        axis_limits(values, axis)
    assert any(str(refused.value).startswith(f'{axis}.{limit} is {value!r}, expected ')
               for limit, value in given.items()), refused.value


@pytest.mark.parametrize('axis', AXES)
def test_a_limit_that_is_switched_off_is_not_refused(axis):
    limits = axis_limits({**DEFAULTS, f'{axis}.min_acceleration': 2.5,
                          f'{axis}.has_acceleration_limits': False}, axis)
    assert not limits.ramps


def test_an_older_limit_still_bounds_every_fall_of_the_velocity():
    limits = axis_limits({**DEFAULTS, 'linear.x.max_acceleration': 1.0,
                          'linear.x.min_acceleration': -2.0}, 'linear.x')
    assert limits.forward_rates == (1.0, 2.0) and limits.reverse_rates == (2.0, 1.0)
