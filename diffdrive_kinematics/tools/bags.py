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
Bags of rosbag2: directories, and single .mcap and .db3 files, read message by message.

They are read by ``rosbags``, which is pure Python (extra ``bags``), or, on a ROS machine without
it, by ``rosbag2_py``.  A directory whose metadata names other files is read by the files in it.
"""

from contextlib import contextmanager, ExitStack
from functools import lru_cache
from importlib import import_module
from pathlib import Path
import struct
from typing import Any, Dict, Iterator, List, NamedTuple, Sequence, Tuple

from rclpy.serialization import deserialize_message

SUFFIXES = ('.mcap', '.db3')
MISSING = (
    "bags need rosbags, which is missing: pip install '.[bags]', or, on a ROS "
    'machine, apt install ros-jazzy-rosbag2-py')
UNREADABLE = (
    OSError, ValueError, LookupError, RuntimeError, AssertionError, EOFError, TypeError,
    AttributeError, ArithmeticError, MemoryError, struct.error)
"""What readers raise beside errors of their own where a file is damaged."""


class BagTopic(NamedTuple):
    """A topic of a bag: its name, its type, and how many messages there are."""

    name: str
    kind: str
    count: int


class BagMessage(NamedTuple):
    """A serialised message: its topic, its type, and when it was received [ns]."""

    topic: str
    kind: str
    received_ns: int
    data: bytes


class Bag:
    """A bag that is open, made of one or more readers, one after the other."""

    def __init__(self, path: str, readers: Sequence[Any], errors: Tuple[type, ...]) -> None:
        self.path, self._readers, self._errors = path, readers, errors
        counts: Dict[Tuple[str, str], int] = {}
        for reader in readers:
            for topic in reader.topics():
                key = topic.name, topic.kind
                counts[key] = counts.get(key, 0) + topic.count
        self.topics = [BagTopic(*key, count) for key, count in sorted(counts.items())]

    def messages(self, topics: Sequence[str]) -> Iterator[BagMessage]:
        """Return the messages of topics; ``ValueError`` where the bag is damaged."""
        try:
            for reader in self._readers:
                yield from reader.messages(topics)
        except self._errors as error:
            raise ValueError(f'{self.path} cannot be read as a bag: {_words(error)}') from error


def is_bag(path: str) -> bool:
    """Return whether a path is that of a bag, by its name."""
    return Path(path).suffix in SUFFIXES or Path(path).is_dir()


@contextmanager
def open_bag(path: str) -> Iterator[Bag]:
    """
    Open a bag.

    Raises
    ------
    ValueError
        If it cannot be read, or nothing is installed that reads it.

    """
    make, errors = _reader()
    with ExitStack() as stack:
        try:
            try:
                readers = [make(path, stack)]
            except errors:
                files = _files_in(path)
                if not files:
                    raise
                readers = [make(str(file), stack) for file in files]
            bag = Bag(path, readers, errors)
        except errors as error:
            raise ValueError(f'{path} cannot be read as a bag: {_words(error)}') from error
        yield bag


def message_of(message: BagMessage) -> Any:
    """Return the message as an object; ``ValueError`` if its bytes are none."""
    package, _, name = message.kind.split('/')
    try:
        try:
            kind = getattr(import_module(f'{package}.msg'), name)
        except ImportError:  # no wheel of tf2_msgs exists
            return _typestore().deserialize_cdr(message.data, message.kind)
        return deserialize_message(message.data, kind)
    except UNREADABLE as error:
        raise ValueError(
            f"a message of '{message.topic}' cannot be read as {message.kind}: {_words(error)}"
        ) from error


@lru_cache
def _typestore() -> Any:
    from rosbags.typesys import get_typestore, Stores
    return get_typestore(Stores.ROS2_JAZZY)


def _words(error: BaseException) -> str:
    return ' '.join(str(error).split()) or type(error).__name__


def _files_in(path: str) -> List[Path]:
    """Return the files of a directory in the order in which rosbag2 numbers them."""
    if not Path(path).is_dir():
        return []
    found = [file for file in Path(path).iterdir() if file.suffix in SUFFIXES]
    return sorted(found, key=lambda file: (len(file.name), file.name))


def _reader() -> Tuple[Any, Tuple[type, ...]]:
    """Return what opens a bag, and the errors that it raises."""
    try:
        from rosbags.rosbag2 import reader, ReaderError, storage_sqlite3
        return _WithRosbags, (
            ReaderError, reader.zstd.ZstdError, storage_sqlite3.apsw.Error, *UNREADABLE)
    except (ImportError, AttributeError):  # missing, or older than 0.11
        pass
    try:
        import_module('rosbag2_py')
    except ImportError as error:
        raise ValueError(f'{MISSING} ({error})') from error
    return _WithRosbag2Py, UNREADABLE


class _WithRosbags:
    """Reads with ``rosbags``."""

    def __init__(self, path: str, stack: ExitStack) -> None:
        from rosbags.rosbag2 import Reader
        self._reader = stack.enter_context(Reader(path))

    def topics(self) -> List[BagTopic]:
        return [BagTopic(each.topic, each.msgtype, each.msgcount)
                for each in self._reader.connections]

    def messages(self, topics: Sequence[str]) -> Iterator[BagMessage]:
        chosen = [each for each in self._reader.connections if each.topic in topics]
        for each, received_ns, data in self._reader.messages(chosen) if chosen else ():
            yield BagMessage(each.topic, each.msgtype, received_ns, bytes(data))


class _WithRosbag2Py:
    """Reads with ``rosbag2_py`` of a ROS installation."""

    STORAGE = {'.mcap': 'mcap', '.db3': 'sqlite3'}

    def __init__(self, path: str, _: ExitStack) -> None:
        self._module: Any = import_module('rosbag2_py')
        self._reader = self._module.SequentialReader()
        self._reader.open(
            self._module.StorageOptions(
                uri=path, storage_id=self.STORAGE.get(Path(path).suffix, '')),
            self._module.ConverterOptions('cdr', 'cdr'))
        self._kinds = {each.name: each.type for each in self._reader.get_all_topics_and_types()}

    def topics(self) -> List[BagTopic]:
        return [
            BagTopic(each.topic_metadata.name, each.topic_metadata.type, each.message_count)
            for each in self._reader.get_metadata().topics_with_message_count]

    def messages(self, topics: Sequence[str]) -> Iterator[BagMessage]:
        self._reader.set_filter(self._module.StorageFilter(topics=list(topics)))
        while self._reader.has_next():
            topic, data, received_ns = self._reader.read_next()
            yield BagMessage(topic, self._kinds[topic], received_ns, data)
