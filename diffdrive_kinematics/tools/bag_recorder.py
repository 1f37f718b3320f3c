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
Writes what nodes publish into an .mcap file of rosbag2, for Foxglove, PlotJuggler and calibrate.

The file is written in a directory beside its place and moved there when it is complete.
``rosbags`` writes it, or ``rosbag2_py`` on a ROS machine without it.
"""

from contextlib import suppress
from importlib import import_module
from pathlib import Path
import shutil
from typing import Any, Callable, Dict, Iterable

from diffdrive_kinematics.tools.bags import MISSING
from diffdrive_kinematics.tools.output_files import (
    beside, check_writable, free_path, part_of, place)
from rclpy.publisher import Publisher
from rclpy.serialization import serialize_message

NOT_OURS = ('/rosout', '/parameter_events')


class BagRecorder:
    """
    A bag that is being written.

    Parameters
    ----------
    path : str
        Of the file, which ends with ``.mcap``.
    overwrite : bool
        Whether a file that is there may be replaced.

    Raises
    ------
    ValueError
        If the file exists or cannot be written, or nothing is installed that writes it.

    """

    def __init__(self, path: str, *, overwrite: bool) -> None:
        check_writable(path, name='record', overwrite=overwrite, regular=True)
        self._path, self._overwrite, self._failed = path, overwrite, ''
        self._directory = Path(part_of(path))
        self._writer: Any = _writer(str(self._directory))
        self.count = 0
        self._first_ns = self._last_ns = 0

    def watch(self, publishers: Iterable[Publisher], now_ns: Callable[[], int]) -> None:
        """Record what publishers publish from now on, at the time of a clock."""
        for publisher in publishers:
            if publisher.topic_name not in NOT_OURS:
                publisher.publish = self._recorded(publisher, publisher.publish, now_ns)

    def _recorded(
            self, publisher: Publisher, publish: Callable[[Any], None],
            now_ns: Callable[[], int]) -> Callable[[Any], None]:
        topic, kind = publisher.topic_name, publisher.msg_type
        name = f"{kind.__module__.partition('.')[0]}/msg/{kind.__name__}"

        def recorded(message: Any) -> None:
            if not self._failed:
                data = message if isinstance(message, bytes) else serialize_message(message)
                try:
                    time_ns = now_ns()
                    self._writer.write(topic, name, time_ns, data)
                    self._first_ns = self._first_ns if self.count else time_ns
                    self._last_ns = time_ns
                    self.count += 1
                except (OSError, RuntimeError) as error:
                    self._failed = str(error)  # the drive goes on
            publish(message)

        return recorded

    def length_s(self) -> float:
        """Return the time [s] from the first to the last message."""
        return (self._last_ns - self._first_ns) / 1e9

    def close(self) -> str:
        """Complete the file and return a line that says so; ``ValueError`` if it cannot be."""
        try:
            if self._failed:
                raise OSError(self._failed)
            self._writer.close()
            written, = self._directory.glob('*.mcap')
            path = free_path(self._path, overwrite=self._overwrite)
            place(str(written), path, overwrite=self._overwrite)
        except (OSError, RuntimeError, ValueError) as error:
            raise ValueError(
                f'record is {self._path!r}, which cannot be written: {error}') from error
        finally:
            self.discard()
        return f'recorded {self.count} messages in {beside(self._path, path)}'

    def discard(self) -> None:
        """Leave nothing of a file that is not complete."""
        self._failed = self._failed or 'closed'
        with suppress(OSError):
            shutil.rmtree(self._directory)


def _writer(directory: str) -> Any:
    """Return what writes a bag into a directory that does not exist yet."""
    try:
        return _WithRosbags(directory)
    except ImportError:
        pass
    try:
        return _WithRosbag2Py(directory)
    except ImportError as error:
        raise ValueError(f'{MISSING} ({error})') from error


class _WithRosbags:
    """Writes with ``rosbags``."""

    def __init__(self, directory: str) -> None:
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import get_typestore, Stores
        self._types = get_typestore(Stores.ROS2_JAZZY)
        self._writer = Writer(directory, version=9, storage_plugin=StoragePlugin.MCAP)
        self._connections: Dict[str, Any] = {}
        self._writer.open()

    def write(self, topic: str, kind: str, time_ns: int, data: bytes) -> None:
        connection = self._connections.get(topic)
        if connection is None:
            connection = self._writer.add_connection(topic, kind, typestore=self._types)
            self._connections[topic] = connection
        self._writer.write(connection, time_ns, data)

    def close(self) -> None:
        self._writer.close()


class _WithRosbag2Py:
    """Writes with ``rosbag2_py`` of a ROS installation."""

    def __init__(self, directory: str) -> None:
        self._module: Any = import_module('rosbag2_py')
        self._writer = self._module.SequentialWriter()
        self._writer.open(
            self._module.StorageOptions(uri=directory, storage_id='mcap'),
            self._module.ConverterOptions('cdr', 'cdr'))
        self._topics: Dict[str, str] = {}

    def write(self, topic: str, kind: str, time_ns: int, data: bytes) -> None:
        if topic not in self._topics:
            self._topics[topic] = kind
            self._writer.create_topic(self._module.TopicMetadata(
                id=len(self._topics), name=topic, type=kind, serialization_format='cdr'))
        self._writer.write(topic, data, time_ns)

    def close(self) -> None:
        self._writer.close()
