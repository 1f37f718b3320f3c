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

"""A driver of wheels as they are, and a base that hears it: for laws of odometry."""

from dataclasses import dataclass, replace
import math
import random
from typing import Callable, Optional, Tuple

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.odometry import Encoder, Odometry, WheelSample

MS = 1_000_000
S = 1000 * MS
START_NS = 1_700_000_000 * S
RADIUS = 0.033
GEOMETRY = WheelGeometry(0.16, RADIUS)


def base(timeout_ns=S // 2, **settings):
    """Return a base that stands at the origin."""
    return Odometry.starting_at(
        Pose(0.0, 0.0, 0.0), geometry=GEOMETRY, timeout_ns=timeout_ns, **settings)


@dataclass(frozen=True)
class Driver:
    """
    What makes messages of the angle of both wheels.

    Parameters
    ----------
    angle : callable
        True angle [rad] at a time [s] since the start.
    period_ns, jitter_ns : int
        Between measurements; by how much at most each is early or late [ns].
    offset_ns, latency_ns : int
        What its clock is behind, and how long messages are under way [ns].
    stamped : bool
        False: stamps are zero, hence those of arrival.
    velocity : callable, optional
        What it tells for a rate [rad/s]; None: no velocities.
    resolution : float
        Ticks a turn; 0: any angle.

    """

    angle: Callable[[float], float]
    period_ns: int = 20 * MS
    jitter_ns: int = 0
    offset_ns: int = 0
    latency_ns: int = MS
    stamped: bool = True
    positions: bool = True
    velocity: Optional[Callable[[float], float]] = None
    resolution: float = 0.0
    filtered_s: float = 0.0

    def rate(self, seconds):
        """Return the true rate [rad/s], late by what the driver's filter takes."""
        at = seconds - self.filtered_s
        return (self.angle(at + 1e-4) - self.angle(at - 1e-4)) / 2e-4

    def messages(self, seconds) -> Tuple[Tuple[int, WheelSample], ...]:
        """Return (arrival, sample) of the messages of a time, in order of arrival."""
        generator, encoder, out = random.Random(1), Encoder(0.0, self.resolution), []
        for number in range(int(seconds * S / self.period_ns) + 1):
            jitter = generator.randint(-self.jitter_ns, self.jitter_ns) if self.jitter_ns else 0
            due_ns = number * self.period_ns
            measured_ns = due_ns + (jitter if self.stamped else 0)
            arrival = START_NS + due_ns + jitter + self.latency_ns
            stamp = START_NS + measured_ns - self.offset_ns if self.stamped else arrival
            angle = encoder.reading(self.angle(measured_ns / S))
            rate = self.velocity and self.velocity(self.rate(measured_ns / S))
            out.append((arrival, WheelSample(
                stamp, None if rate is None else (rate, rate),
                (angle, angle) if self.positions else None)))
        return tuple(sorted(out, key=lambda message: message[0]))


def driven(odometry, messages, tick_ns=10 * MS, until_ns=None):
    """Return the readings at ticks as (time, reading), and the odometry after the messages."""
    readings, time = [], START_NS
    end = until_ns or messages[-1][0] + tick_ns
    messages = list(messages)
    while time < end:
        time += tick_ns
        while messages and messages[0][0] <= time:
            arrival, sample = messages.pop(0)
            odometry, _ = odometry.update(sample, arrival)
        readings.append((time, odometry.predict(time)))
    return readings, odometry


def seconds_of(time_ns):
    """Return the time [s] since the start."""
    return (time_ns - START_NS) / S


def turned_by(messages, source):
    """Return the messages as those of another source."""
    return [(arrival, replace(sample, source=source)) for arrival, sample in messages]


def steady(rate):
    """Return the angle of a wheel that turns at a rate [rad/s]."""
    return lambda seconds: rate * seconds


def ramp(rate, start, seconds):
    """Return the angle of a wheel that gains a rate [rad/s] from a time on, within a time [s]."""
    def angle(at):
        up = min(max(at - start, 0.0), seconds)
        return 0.5 * rate * up * up / seconds + rate * max(at - start - seconds, 0.0)
    return angle


def sway(rate, period):
    """Return the angle of a wheel that turns to and fro."""
    return lambda at: rate * period / math.tau * (1.0 - math.cos(math.tau * at / period))
