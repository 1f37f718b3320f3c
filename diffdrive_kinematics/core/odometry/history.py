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

"""The odometry as it was at a time that is past."""

from dataclasses import dataclass
from typing import Tuple

from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.core.odometry.odometry import Odometry

LONGEST = 128


@dataclass(frozen=True)
class OdometryHistory:
    """
    The last anchors of an odometry, for its pose at a stamp that a later message has passed.

    Parameters
    ----------
    past : tuple of Odometry
        At least one, by rising anchors; what is asked before the first is answered by it.

    Examples
    --------
    The pose half a second after a start with 1 m/s, asked for a second after it:

    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> from diffdrive_kinematics.core.odometry import WheelSample
    >>> odometry = Odometry.starting_at(
    ...     Pose(0.0, 0.0, 0.0), geometry=WheelGeometry(0.5, 0.125), timeout_ns=None)
    >>> history = OdometryHistory((odometry,))
    >>> odometry, _ = odometry.update(WheelSample(0, (8.0, 8.0)), now_ns=0)
    >>> history = history.followed(odometry)
    >>> history.pose_at(500_000_000).x
    0.5

    """

    past: Tuple[Odometry, ...]

    def followed(self, odometry: Odometry) -> 'OdometryHistory':
        """
        Return the history with what the odometry is now; one that went back begins anew.

        Parameters
        ----------
        odometry : Odometry
            The odometry after a message.

        Returns
        -------
        OdometryHistory
            The history, of 128 anchors at most.

        Examples
        --------
        See :class:`OdometryHistory`.

        """
        anchor, last = _anchor(odometry), _anchor(self.past[-1])
        if anchor < last:
            return OdometryHistory((odometry,))
        kept = self.past[:-1] if anchor == last else self.past
        return OdometryHistory((*kept, odometry)[-LONGEST:])

    def pose_at(self, time_ns: int) -> Pose:
        """
        Return the pose at a time [ns] on the own clock.

        Parameters
        ----------
        time_ns : int
            Time that is asked for [ns].

        Returns
        -------
        Pose
            Pose at that time, theta in (-pi, pi].

        Examples
        --------
        See :class:`OdometryHistory`.

        """
        for odometry in reversed(self.past):
            if odometry.clock.own_ns(_anchor(odometry)) <= time_ns:
                return odometry.predict(time_ns).pose
        return self.past[0].predict(time_ns).pose


def _anchor(odometry: Odometry) -> int:
    motion = odometry.motion
    return motion.anchor_ns if motion else 0
