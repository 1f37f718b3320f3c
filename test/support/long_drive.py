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

"""A long drive through the core, and where it ends to 50 digits."""

from diffdrive_kinematics.core.commands import Drive, DriveSettings, Twist
from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.odometry import Odometry, WheelSample
import mpmath
import numpy as np

PERIOD_NS = 20_000_000
COMMANDS = 500
DIGITS = 50


class Course:
    """
    A lap of commands of 20 ms each, all with rates of their own.

    The commands go in and out of curves, so that the way stays within a few metres but the
    wheels roll on: 0.4 m/s are 720,000 rad in 30 hours.
    """

    def __init__(self, seed=1):
        generator = np.random.default_rng(seed)
        self.geometry = WheelGeometry(0.0885, 0.021)
        self.twists = [Twist(float(v), float(w)) for v, w in zip(
            generator.uniform(0.3, 0.5, COMMANDS), generator.uniform(-1.0, 1.4, COMMANDS))]

    def driven(self, laps, odometry=None):
        """Return the reading after some laps that begin with ``odometry``."""
        drive = Drive(DriveSettings(self.geometry, cmd_vel_timeout=0.0), 0)
        odometry = odometry or Odometry.starting_at(
            Pose(0.0, 0.0, 0.0), geometry=self.geometry, timeout_ns=None)
        now = PERIOD_NS
        for _ in range(laps):
            for twist in self.twists:
                drive, (told, *_) = drive.commanded(twist, now)
                odometry, _ = odometry.update(
                    WheelSample(now, told.rates, told.angles, '/drive#1'), now)
                now += PERIOD_NS
        return odometry.predict(now)

    def exact(self, laps, start=(0.0, 0.0, 0.0)):
        """Return (x, y, theta) after some laps, as the commands say, with 50 digits."""
        with mpmath.workdps(DIGITS):
            seconds = mpmath.mpf(PERIOD_NS) / 10**9
            move, turn = mpmath.mpc(0), mpmath.mpf(0)
            for v, w in self.twists:
                half = mpmath.mpf(w) * seconds / 2
                chord = mpmath.mpf(v) * seconds * mpmath.sinc(half)
                move += chord * mpmath.expj(turn + half)
                turn += 2 * half
            lap = mpmath.expj(turn)  # the sum of its powers from 0 to laps - 1
            all_laps = move * (lap**laps - 1) / (lap - 1)
            end = mpmath.mpc(*start[:2]) + mpmath.expj(start[2]) * all_laps
            return end.real, end.imag, start[2] + laps * turn
