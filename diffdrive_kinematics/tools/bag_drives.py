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

"""What bags have of a drive: wheel motion, commands, and a reference, by topic and type."""

from collections import Counter
from dataclasses import dataclass, field
import math
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import wheel_rates_from_twist, WheelGeometry
from diffdrive_kinematics.core.noise import planar_pose
from diffdrive_kinematics.core.odometry import WheelSample
from diffdrive_kinematics.ros.messages.messages import nanoseconds, pose_in_plane
from diffdrive_kinematics.ros.messages.wheel_joints import wheel_joints
from diffdrive_kinematics.ros.messages.wheel_messages import WheelReader
from diffdrive_kinematics.tools.bags import Bag, BagMessage, BagTopic, message_of, open_bag
from diffdrive_kinematics.tools.collection import Collection
from diffdrive_kinematics.tools.recordings import nobody, Progress

COMMANDS = 'commands'
PROGRESS_MESSAGES = 4096
STAMP = slice(4, 12)  # of a serialised message that begins with a header
JOINTS, ODOMETRY = 'sensor_msgs/msg/JointState', 'nav_msgs/msg/Odometry'
TWISTS = 'geometry_msgs/msg/Twist', 'geometry_msgs/msg/TwistStamped'
TF = 'tf2_msgs/msg/TFMessage'
MOTIONS = (JOINTS, *TWISTS, ODOMETRY)
REFERENCES = (
    ODOMETRY, 'geometry_msgs/msg/PoseStamped', 'geometry_msgs/msg/PoseWithCovarianceStamped', TF)

Handle = Callable[[BagMessage], None]


class Read(NamedTuple):
    """What was read: the kind of motion, and what is to be said of it."""

    kind: str
    remarks: Tuple[str, ...]


@dataclass
class Times:
    """Counts which messages were dated by their header, and which by when they were received."""

    counts: 'Counter[bool]' = field(default_factory=Counter)

    def of(self, stamp_ns: int, received_ns: int) -> int:
        """Return the time of a message [ns]."""
        self.counts[bool(stamp_ns)] += 1
        return stamp_ns or received_ns

    def words(self) -> str:
        """Return what is to be said about it."""
        if self.counts[True] and self.counts[False]:
            return (f'by the stamps of {self.counts[True]} headers and the time of reception of '
                    f'{self.counts[False]} messages')
        return 'by the stamps of headers' if self.counts[True] else 'by the time of reception'


def add_bag(
        collection: Collection, path: str, values: Mapping[str, Any], geometry: WheelGeometry,
        progress: Progress = nobody, *, motion: bool = True, reference: bool = True) -> Read:
    """
    Add the motion of a bag, its reference, or both, to a collection.

    Parameters
    ----------
    collection : Collection
        To which they are added.
    path : str
        Of the bag.
    values : mapping
        ``motion_topic``, ``reference_topic``, ``reference_frames``, and those of the wheels.
    geometry : WheelGeometry
        Which makes wheel rates of twists.
    progress : callable
        Is told how far it is.
    motion, reference : bool
        What is added.

    Raises
    ------
    ValueError
        If a topic is not there, or of a type that says nothing, or a message is none; the
        message lists what the bag has.

    """
    with open_bag(path) as bag:
        handles: Dict[str, Handle] = {}
        said: List[Tuple[BagTopic, Times]] = []
        kind = ''
        if motion:
            topic, times = topic_of(bag, 'motion_topic', values, MOTIONS), Times()
            kind = COMMANDS if topic.kind in TWISTS else 'wheel_positions'
            handles[topic.name] = (
                _joints_handle(collection, values, times) if topic.kind == JOINTS
                else _twist_handle(collection, geometry, times))
            said.append((topic, times))
        if reference:
            topic, times = topic_of(bag, 'reference_topic', values, REFERENCES), Times()
            if topic.name in handles:
                raise ValueError(
                    f'{path}: motion_topic and reference_topic are both {topic.name!r}, expected '
                    f'different topics, of: {_listed(bag)}')
            handles[topic.name] = (
                _transform_handle(collection, values, times) if topic.kind == TF
                else _pose_handle(collection, times))
            said.append((topic, times))
        read_topics(bag, handles, progress)
        for topic, times in said:
            if not times.counts:
                raise ValueError(f'{path}: {_nothing(bag, topic, values)}')
    return Read(kind, tuple(
        f"{path}: '{topic.name}' ({topic.kind.split('/')[-1]}, {sum(times.counts.values())} "
        f'messages) {times.words()}' for topic, times in said))


def topic_of(
        bag: Bag, parameter: str, values: Mapping[str, Any], kinds: Sequence[str]) -> BagTopic:
    """Return the topic of a parameter; ``ValueError`` lists the topics where it is not there."""
    name = values[parameter]
    named = [each for each in bag.topics if each.name.lstrip('/') == name.lstrip('/')]
    found = [each for each in named if each.kind in kinds and each.count]
    if not found:
        what = (f'is of type {named[0].kind} with {named[0].count} messages'
                if named else 'is not in the bag')
        raise ValueError(
            f'{bag.path}: {parameter} {name!r} {what}, expected a topic with messages of '
            f"{', '.join(kind.split('/')[-1] for kind in kinds)}; it has: {_listed(bag)}")
    return found[0]


def _listed(bag: Bag) -> str:
    return ', '.join(
        f'{each.name} ({each.kind}, {each.count})' for each in bag.topics) or 'no topics'


def _nothing(bag: Bag, topic: BagTopic, values: Mapping[str, Any]) -> str:
    """Return why no message of a topic was of use."""
    first = message_of(next(iter(bag.messages([topic.name]))))
    if topic.kind == JOINTS:
        wanted = list(wheel_joints(values).all_names())
        return (f"'{topic.name}' has the joints {list(first.name)!r}, expected {wanted!r}: set "
                'left_wheel_names and right_wheel_names')
    pairs = Counter(
        _frames(each) for message in bag.messages([topic.name])
        for each in message_of(message).transforms)
    listed = ', '.join(f'[{parent}, {child}] ({count})'
                       for (parent, child), count in sorted(pairs.items()))
    return (f"reference_frames is {list(values['reference_frames'])!r}, expected the parent and "
            f'the child frame of the reference, one of: {listed}')


def read_topics(bag: Bag, handles: Mapping[str, Handle], progress: Progress = nobody) -> None:
    """Hand each message of topics on; ``ValueError`` names the one that is none."""
    for number, message in enumerate(bag.messages(list(handles)), start=1):
        try:
            handles[message.topic](message)
        except (ValueError, OverflowError, RuntimeError) as error:
            raise ValueError(
                f"{bag.path}, message {number} of {list(handles)!r}, '{message.topic}': "
                f"{' '.join(str(error).split())}") from error
        if not number % PROGRESS_MESSAGES:
            progress(f'{bag.path}: {number} messages')


def _joints_handle(collection: Collection, values: Mapping[str, Any], times: Times) -> Handle:
    reader = WheelReader.of(values)

    def handle(message: BagMessage) -> None:
        sample = reader.read(message.data, lambda: message.received_ns)
        if sample is not None:
            times.of(sample.stamp_ns if any(message.data[STAMP]) else 0, message.received_ns)
            collection.add_wheels(sample)

    return handle


def twist_of(message: BagMessage) -> Tuple[int, float, float]:
    """Return (stamp [ns], 0 for none; v; w) of a Twist, TwistStamped or Odometry."""
    read = message_of(message)
    header, twist = getattr(read, 'header', None), getattr(read, 'twist', read)
    twist = getattr(twist, 'twist', twist)
    v, w = twist.linear.x, twist.angular.z
    if not (math.isfinite(v) and math.isfinite(w)):
        raise ValueError(f'linear.x, angular.z are {v}, {w}, expected finite numbers')
    return nanoseconds(header.stamp) if header else 0, v, w


def _twist_handle(collection: Collection, geometry: WheelGeometry, times: Times) -> Handle:
    def handle(message: BagMessage) -> None:
        stamp_ns, v, w = twist_of(message)
        left, right = wheel_rates_from_twist(geometry, v, w)
        collection.add_wheels(WheelSample(
            times.of(stamp_ns, message.received_ns), (float(left), float(right))))

    return handle


def _pose_handle(collection: Collection, times: Times) -> Handle:
    def handle(message: BagMessage) -> None:
        read = message_of(message)
        pose = getattr(read.pose, 'pose', read.pose)
        collection.add_pose(
            times.of(nanoseconds(read.header.stamp), message.received_ns), pose_in_plane(pose))

    return handle


def _transform_handle(collection: Collection, values: Mapping[str, Any], times: Times) -> Handle:
    wanted = tuple(name.lstrip('/') for name in values['reference_frames'])

    def handle(message: BagMessage) -> None:
        for each in message_of(message).transforms:
            if _frames(each) == wanted:
                at, q = each.transform.translation, each.transform.rotation
                collection.add_pose(
                    times.of(nanoseconds(each.header.stamp), message.received_ns),
                    planar_pose(at.x, at.y, (q.x, q.y, q.z, q.w)))

    return handle


def _frames(transform: Any) -> Tuple[str, str]:
    return transform.header.frame_id.lstrip('/'), transform.child_frame_id.lstrip('/')
