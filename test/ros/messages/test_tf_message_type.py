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

"""``/tf`` without tf2_msgs: what others see of its type, and what is said where there is none."""

from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.ros.messages import tf_message_type as made
from diffdrive_kinematics.ros.messages.codec import TransformCodec
from diffdrive_kinematics.ros.publishers import tf
import pytest
from rclpy.serialization import deserialize_message
from rosidl_generator_type_description import calculate_type_hash
from support.graph import KHEPERA
from support.inside import initialised, inside
from type_description_interfaces.srv import GetTypeDescription

NAME = 'tf2_msgs/msg/TFMessage'


def as_dict(value):
    """Return a message as ``json`` would read it."""
    if isinstance(value, list):
        return [as_dict(each) for each in value]
    if not hasattr(value, 'get_fields_and_field_types'):
        return value
    return {name: as_dict(getattr(value, name)) for name in value.get_fields_and_field_types()}


@pytest.fixture
def without_a_type(monkeypatch):
    monkeypatch.setattr(tf, '_message_type', lambda: None)


def test_the_type_is_described_to_others_and_has_the_hash_of_its_description(graph):
    base = graph.start('simulated_base', {**KHEPERA, 'enable_odom_tf': True})
    graph.wait_for(lambda: graph.node.get_publishers_info_by_topic('/tf'), '/tf')
    info, = graph.node.get_publishers_info_by_topic('/tf')
    assert info.topic_type == NAME and 'tf is off' not in base.output
    type_hash = f'RIHS01_{bytes(info.topic_type_hash.value).hex()}'
    described = graph.call(
        GetTypeDescription, 'simulated_base/get_type_description',
        GetTypeDescription.Request(type_name=NAME, type_hash=type_hash))
    assert described.successful, described.failure_reason
    description = as_dict(described.type_description)
    assert calculate_type_hash(description) == type_hash
    assert [field['name'] for field in description['type_description']['fields']] == ['transforms']


def test_its_messages_are_bytes():
    with initialised(), pytest.raises((TypeError, RuntimeError)):
        deserialize_message(b'\x00\x01\x00\x00\x00\x00\x00\x00', made.tf_message_type())


@pytest.mark.parametrize('name, value', [
    ('get_rmw_implementation_identifier', lambda: 'rmw_cyclonedds_cpp'),
    ('PATH', (b'Path', 2, 48, [])), ('FIELDS', b'no_typesupport_of_this_name')],
    ids=['middleware', 'type supports', 'no type supports'])
def test_none_is_made_for_what_is_built_otherwise(monkeypatch, name, value):
    monkeypatch.setattr(made, name, value)
    assert made.tf_message_type.__wrapped__() is None


@pytest.mark.parametrize('given, level', [({}, 'INFO'), ({'enable_odom_tf': True}, 'WARN')])
def test_where_there_is_no_type_one_line_says_so_and_warns_only_who_asked_for_tf(
        without_a_type, capfd, given, level):
    with inside(SimulatedBase, {**KHEPERA, **given}) as held:
        assert '/tf' not in held.said and '/odom' in held.said
    line, = [line for line in capfd.readouterr().err.splitlines() if 'tf is off' in line]
    assert level in line and 'set enable_odom_tf to false to run without it' in line


def test_where_there_is_no_type_a_ground_truth_listens_to_no_belief(without_a_type, capfd):
    with inside(SimulatedBase, {
            **KHEPERA, 'enable_odom_tf': False, 'publish_map_odom_tf': True,
            'odom_frame_id': 'map', 'odom_topic': 'ground_truth'}) as held:
        assert '/odom' not in held._heard
    assert capfd.readouterr().err.count('set publish_map_odom_tf to false') == 1


def test_whoever_has_tf2_msgs_hears_it(graph):
    real = pytest.importorskip('tf2_msgs.msg').TFMessage
    with_it = graph.collect(real, '/tf')
    publisher = graph.node.create_publisher(made.tf_message_type(), '/tf', 10)
    data = TransformCodec('odom', 'base_link').encode(1_500_000_000, Pose(1.0, 2.0, 0.5))
    graph.wait_for(lambda: publisher.publish(data) or with_it, 'a transform')
    assert with_it[0] == deserialize_message(data, real)
    assert with_it[0].transforms[0].transform.translation.x == 1.0
