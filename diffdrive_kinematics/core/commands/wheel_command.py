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

"""What is commanded: a twist of the robot, and the wheel rates that go with it."""

from typing import NamedTuple, Tuple


class Twist(NamedTuple):
    """
    A twist of the robot.

    Parameters
    ----------
    v : float
        Forward speed [m/s].
    w : float
        Yaw rate [rad/s], counter-clockwise positive.

    Examples
    --------
    >>> Twist(0.5, w=1.0).w
    1.0

    """

    v: float
    w: float

    def exceeds(self, asked: 'Twist') -> bool:
        """
        Return whether a speed or yaw rate is more than what is asked for, or of another sign.

        Parameters
        ----------
        asked : Twist
            What is asked for.

        Returns
        -------
        bool
            Whether a robot with this twist is faster than asked, as where a ramp brakes it.

        Examples
        --------
        >>> Twist(0.5, 0.0).exceeds(Twist(0.2, 0.0)), Twist(0.2, 0.0).exceeds(Twist(0.5, 1.0))
        (True, False)

        """
        return any(abs(now) > abs(most) or now * most < 0.0 for now, most in zip(self, asked))


STILL = Twist(0.0, 0.0)


class WheelCommand(NamedTuple):
    """
    What to tell at a time.

    Parameters
    ----------
    stamp_ns : int
        The time [ns].
    rates : pair of float
        Wheel rates (left, right) [rad/s] from then on.
    angles : pair of float
        Angles (left, right) [rad] commanded up to then.
    twist : Twist
        What the rates amount to.

    Examples
    --------
    >>> WheelCommand(0, rates=(4.0, 4.0), angles=(0.0, 0.0), twist=Twist(0.5, 0.0)).twist.v
    0.5

    """

    stamp_ns: int
    rates: Tuple[float, float]
    angles: Tuple[float, float]
    twist: Twist
