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

"""Recorded commands, of a CSV file or a bag, for ``command_sequence``."""

from typing import List, Tuple

from diffdrive_kinematics.tools.bag_drives import read_topics, Times, topic_of, twist_of, TWISTS
from diffdrive_kinematics.tools.bags import BagMessage, is_bag, open_bag
from diffdrive_kinematics.tools.plausible import check_commands, check_stamps
from diffdrive_kinematics.tools.recordings import COMMAND_COLUMNS, read_columns
import numpy as np


def read_commands(path: str, topic: str) -> List[Tuple[float, float, float]]:
    """
    Return (time [s], v [m/s], w [rad/s]) of recorded commands.

    Raises
    ------
    ValueError
        If the file cannot be read or has no such columns (a bag: no such topic), or is in other
        units.

    """
    rows = (_of_bag(path, topic) if is_bag(path)
            else [(time, v, w) for time, v, w in read_columns(path, COMMAND_COLUMNS).tolist()])
    if rows:
        numbers = np.array(rows)
        check_stamps(path, numbers[:, 0], commands=True)
        check_commands(path, numbers)
    return rows


def _of_bag(path: str, topic: str) -> List[Tuple[float, float, float]]:
    found: List[Tuple[int, float, float]] = []
    times = Times()

    def add(message: BagMessage) -> None:
        stamp_ns, v, w = twist_of(message)
        found.append((times.of(stamp_ns, message.received_ns), v, w))

    with open_bag(path) as bag:
        chosen = topic_of(bag, 'cmd_vel_topic', {'cmd_vel_topic': topic}, TWISTS)
        read_topics(bag, {chosen.name: add})
    return [((time_ns - found[0][0]) / 1e9, v, w) for time_ns, v, w in found]
