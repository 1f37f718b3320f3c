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

"""A course that is driven on stepped time by a belief and a truth beside it."""

from support.graph import KHEPERA
from support.stepped import last

__all__ = ['driven']

REST_S = 2.0
NODES = ['diff_drive_controller', 'wheel_noise', 'simulated_base', 'simulated_base:truth']


def driven(diffdrive, course, clock_step, **sections):
    """Drive (v, w, seconds) one after the other; return the last odometry of belief and truth."""
    robot = diffdrive(
        {'/**': {'nodes': NODES},
         '/truth': {'wheel_motion_topic': 'noisy_wheel_rates', 'odom_topic': 'ground_truth',
                    'odom_frame_id': 'map'},
         **{f'/{node}': values for node, values in sections.items()}},
        params={**KHEPERA, 'publish_rate': 1.0 / clock_step, 'enable_odom_tf': False,
                'joint_states_topic': ''}, clock_step=clock_step)
    for command in (*course, (0.0, 0.0, REST_S)):
        robot.drive(*command)
    ends = [last(robot, topic) for topic in ('odom', 'ground_truth')]
    assert not any(message.twist.twist.linear.x for message in ends)
    return ends
