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

"""Messages with many poses, compared with messages made by hand, and their cost."""

import math
import time

from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.ros.messages import codec
from diffdrive_kinematics.ros.messages.messages import quaternion_of, set_stamp
from geometry_msgs.msg import Point32, PolygonStamped, Pose as PoseMsg, PoseArray, PoseStamped
from hypothesis import given, settings, strategies as st
from nav_msgs.msg import Path
import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Header

NAMES = st.text(st.characters(codec='utf-8', exclude_characters='\0'), max_size=20)
NUMBERS = st.floats(-1e12, 1e12)
STAMPS = st.integers(0, (2**31 - 1) * 10**9 - 1)
POSES = st.builds(Pose, NUMBERS, NUMBERS, st.floats(-math.pi, math.pi))


def header_of(frame_id, time_ns):
    header = Header(frame_id=frame_id)
    set_stamp(header.stamp, time_ns)
    return header


def pose_of(pose):
    message = PoseMsg()
    message.position.x, message.position.y = pose.x, pose.y
    message.orientation.z, message.orientation.w = quaternion_of(pose.theta)
    return message


def row_of(pose):
    return [pose.x, pose.y, 0.0, 0.0, 0.0, *quaternion_of(pose.theta)]


def path_of(frame_id, timed, most):
    """Return a path as a message object."""
    path = Path(header=header_of(frame_id, timed[-1][0] if timed else 0))
    path.poses = [PoseStamped(header=header_of(frame_id, time_ns), pose=pose_of(pose))
                  for time_ns, pose in timed[-most:]]
    return path


def assert_says(ours, message):
    """Compare what others read, and the length: what only aligns may be anything."""
    if not isinstance(ours, bytes):
        ours = bytes(serialize_message(ours))
    assert deserialize_message(ours, type(message)) == message
    assert 0 <= len(serialize_message(message)) - len(ours) < 4  # rclpy fills up to four


@settings(deadline=None)
@given(frame=NAMES, stamp=STAMPS, poses=st.lists(POSES, max_size=5))
def test_samples_of_the_pose_are_a_pose_array(frame, stamp, poses):
    header = header_of(frame, stamp)
    rows = np.array(list(map(row_of, poses))).reshape(-1, 7)
    assert_says(codec.encode_poses(header, rows), PoseArray(
        header=header, poses=list(map(pose_of, poses))))


@settings(deadline=None)
@given(frame=NAMES, stamp=STAMPS, points=st.lists(st.tuples(NUMBERS, NUMBERS), max_size=5))
def test_a_boundary_is_a_polygon_of_single_precision(frame, stamp, points):
    message = PolygonStamped(header=header_of(frame, stamp))
    message.polygon.points = [Point32(x=x, y=y) for x, y in points]
    rounded = deserialize_message(serialize_message(message), PolygonStamped)
    x, y = np.array(points).reshape(-1, 2).T
    assert_says(codec.encode_polygon(message.header, x, y), rounded)


@settings(deadline=None)
@given(frame=NAMES, timed=st.lists(st.tuples(STAMPS, POSES), max_size=6),
       most=st.integers(1, 4))
def test_a_path_has_its_last_poses_each_with_its_time(frame, timed, most):
    message = codec.PathCodec(frame, most)
    for time_ns, pose in timed:
        message.add(time_ns, pose)
    assert len(message) == min(most, len(timed))
    assert_says(message.encode(), path_of(frame, timed, most))


def test_a_path_that_was_cleared_begins_anew():
    message, late = codec.PathCodec('odom', 3), (5, Pose(1.0, 2.0, 3.0))
    message.add(4, Pose(0.0, 0.0, 0.0))
    message.clear()
    message.add(*late)
    assert_says(message.encode(), path_of('odom', [late], 3))


@pytest.mark.slow
@pytest.mark.parametrize('kind', ['path', 'samples'])
def test_many_poses_cost_a_small_part_of_what_message_objects_cost(kind):
    """Compare the time of the thread, side by side: 20,000 objects hold up a loop for 0.1 s."""
    poses = [Pose(0.1 * i, 0.2, 0.3) for i in range(20_000)]
    long = codec.PathCodec('odom', len(poses))
    for i, pose in enumerate(poses):
        long.add(i, pose)
    rows = np.array(list(map(row_of, poses)))
    objects = path_of('odom', list(enumerate(poses)), len(poses))
    ours = {'path': long.encode,
            'samples': lambda: codec.encode_poses(Header(), rows)}[kind]

    def cost(make):
        seconds = []
        for _ in range(3):
            began = time.thread_time()
            make()
            seconds.append(time.thread_time() - began)
        return min(seconds)

    assert cost(ours) < 0.1 * cost(lambda: serialize_message(objects))
