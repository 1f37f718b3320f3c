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

"""What is odd about somebody else's driver of wheels: said once, and on the diagnostics."""

import math
from typing import Any, Dict, List, Optional

from diffdrive_kinematics.core.odometry import Mismatch, Odometry
from diffdrive_kinematics.ros.runtime.diagnostics import Finding, Problem, WARN

ALIKE = 1.1  # a factor within a tenth of a known one is that
UNITS = {'rpm': 30.0 / math.pi, 'deg/s': 180.0 / math.pi, 'turns/s': 0.5 / math.pi}
NOTHING = 0.02  # of what the positions say
STANDING = 0.1  # [rad]
SINCE_BOOT_S = 1e8


def clock_text(offset_ns: int, topic: str) -> str:
    """Return the report on stamps of a clock that is behind ours by an offset [ns]."""
    seconds = offset_ns / 1e9
    where = f'{abs(seconds):.3f} s {"behind" if seconds > 0.0 else "ahead of"}'
    if seconds > SINCE_BOOT_S:
        remedy = 'does its sender stamp the time since boot, or simulated time?'
    elif seconds < -SINCE_BOOT_S:
        remedy = 'is use_sim_time true here, and not where it comes from?'
    else:
        remedy = 'synchronise the clocks, or find what is late'
    return (f"wheel motion on '{topic}' is stamped by a clock {where} ours, which is corrected: "
            f'{remedy}')


def velocity_text(disagreement: Mismatch, radius: float, topic: str) -> str:
    """Return the report on velocities that do not agree with the positions."""
    side, reported, rolled = disagreement
    wheels = 'both wheels' if side == 'both' else f'the {side} wheel'
    if abs(rolled) <= min(STANDING, abs(reported)):
        says = f'says {reported:.3g} rad while the positions say {rolled:.3g} rad'
        reason = 'is it a set point, or what is configured?'
    else:
        factor = reported / rolled
        says = f'is {factor:.3g} times what the positions say'
        reason = _reason(factor, radius)
    return (f"velocity of {wheels} on '{topic}' {says}: {reason} Only the positions "
            'are used; expected rad/s, or an empty field')


def _reason(factor: float, radius: float) -> str:
    """Return the likely reason of a factor between velocities and positions."""
    if abs(factor) <= NOTHING:
        return 'is it never filled in?'
    units = {**UNITS, 'm/s': radius}
    unit = next((name for name, scale in units.items() if _alike(abs(factor), scale)), None)
    if unit is None and _alike(abs(factor), 1.0):
        return 'does one of them have the wrong sign?'
    sign = ', with the other sign' if factor < 0.0 else ''
    return f'in {unit}{sign}?' if unit else f'in ticks, or another unit{sign}?'


def _alike(factor: float, scale: float) -> bool:
    return scale / ALIKE <= factor <= scale * ALIKE


class DriverWatch:
    """
    Looks at an odometry that has heard wheel motion, and says what is new about its sender.

    Parameters
    ----------
    node : DiffDriveNode
        That listens.
    topic : str
        Of wheel motion, as the node names it.

    """

    def __init__(self, node: Any, topic: str) -> None:
        self._topic = node.resolve_topic_name(topic)
        self._gear_ratio = node.config.values['gear_ratio']  # m/s are those of the wheel
        self._clock, self._velocity = Finding(node), Finding(node)
        self._disagreement: Optional[Mismatch] = None

    def look(self, odometry: Odometry) -> None:
        """Say what has changed; to be called where the clock or the measured wheels have."""
        clock = odometry.clock
        if clock.differs:
            self._clock.note(clock_text(clock.offset_ns, self._topic))
        elif not clock.apart:
            self._clock.note('', f"stamps on '{self._topic}' agree with our clock again")
        disagreement = odometry.measured.check.disagreement if odometry.measured else None
        if disagreement is self._disagreement:
            return
        self._disagreement = disagreement
        radius = odometry.geometry.left_radius / self._gear_ratio
        self._velocity.note(
            velocity_text(disagreement, radius, self._topic) if disagreement else '',
            f"velocities on '{self._topic}' agree with the positions, and are used")

    def problems(self) -> List[Problem]:
        """Return what is wrong, for diagnostics."""
        return [Problem(WARN, each.text) for each in (self._clock, self._velocity) if each.text]

    def values(self, odometry: Odometry) -> Dict[str, Any]:
        """Return what there is to know, for diagnostics."""
        measured = odometry.measured
        believed = measured and (
            'agree' if measured.check.believed else
            'disagree' if self._disagreement else 'not used')
        return {'stamps are behind by [s]': odometry.clock.offset_ns / 1e9,
                'velocities and positions': believed or 'as reported'}
