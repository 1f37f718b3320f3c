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

"""A composition in fast mode: a course that is driven by a belief and a truth beside it."""

from nav_msgs.msg import Odometry
from std_msgs.msg import Empty
from support.graph import KHEPERA


def write_params(path, sections):
    """Write the parameters of each section; return the path as text."""
    path.write_text('\n'.join(
        f'{node}:\n  ros__parameters:\n' + '\n'.join(
            f'    {name}: {str(value).lower() if isinstance(value, bool) else value}'
            for name, value in values.items()) for node, values in sections.items() if values))
    return str(path)


def robot_with_truth(commands, clock_step, **sections):
    """Return the sections of a robot that drives commands, with those given of its nodes."""
    return {
        '/**': {
            **KHEPERA, 'clock_step': clock_step, 'real_time_factor': 0.0,
            'publish_rate': 1.0 / clock_step, 'enable_odom_tf': False,
            'joint_states_topic': "''", 'nodes': [
                'command_sequence', 'diff_drive_controller', 'wheel_noise', 'simulated_base',
                'simulated_base:truth']},
        '/command_sequence': {'commands': commands, 'wait_for_topics': ['odom', 'go']},
        '/truth': {'wheel_motion_topic': 'noisy_wheel_rates', 'odom_topic': 'ground_truth',
                   'odom_frame_id': 'map'},
        **{f'/{node}': values for node, values in sections.items()}}


def driven(graph, path, sections):
    """Drive a robot with a truth to its end; return the last message of each, by topic."""
    last = {}
    for topic in ('odom', 'ground_truth'):
        graph.collect(Odometry, topic, lambda message, topic=topic: last.update({topic: message}))
    go = graph.publisher(Empty, 'go', listeners=0)
    sim = graph.start('diffdrive_sim', args=[
        '--ros-args', '--params-file', write_params(path, sections)])
    graph.wait_for(lambda: len(last) == 2 or not sim.running, 'odometry of both')
    graph.play_out(sim, go)
    return last
