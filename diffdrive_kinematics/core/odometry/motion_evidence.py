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

"""What is known of the wheels when a sample comes: by the rates held, and by its positions."""

import math
from typing import NamedTuple, Optional

from diffdrive_kinematics.core.odometry.wheel_motion import rolled, WheelMotion
from diffdrive_kinematics.core.odometry.wheel_sample import WheelPair, WheelSample


class Evidence(NamedTuple):
    """
    What is known of the wheels at a sample.

    Parameters
    ----------
    timeout_ns : int or None
        Silence after which the wheels stop [ns]; None: they never stop by themselves.
    stamp_ns : int
        Time from which the sample holds [ns]: after the anchor.
    held : pair of float
        Rolled since the anchor [rad], where the rates were held.
    measured : pair of float
        The same by the positions, where they count, else as held.
    counts : bool
        Whether the positions count.
    agrees : bool
        Whether both say the same.

    Examples
    --------
    See :func:`evidence_of`.

    """

    timeout_ns: Optional[int]
    stamp_ns: int
    held: WheelPair
    measured: WheelPair
    counts: bool
    agrees: bool


def evidence_of(motion: WheelMotion, sample: WheelSample, timeout_ns: Optional[int]) -> Evidence:
    """
    Return what is known of the wheels at a sample.

    Parameters
    ----------
    motion : WheelMotion
        What the wheels do, by the samples before.
    sample : WheelSample
        The new one.
    timeout_ns : int or None
        Silence after which the wheels stop [ns]; None: they never stop by themselves.

    Returns
    -------
    Evidence
        By the rates held, and by the positions.

    Examples
    --------
    >>> motion = WheelMotion(0, 0, rates=(1.0, 2.0), reference=(7.0, 8.0), holds=True)
    >>> sample = WheelSample(500_000_000, rates=(1.0, 2.0), positions=(7.5, 10.0))
    >>> evidence = evidence_of(motion, sample, timeout_ns=None)
    >>> evidence.held, evidence.measured, evidence.agrees
    ((0.5, 1.0), (0.5, 2.0), False)

    """
    stamp_ns, positions, reference = sample.stamp_ns, sample.positions, motion.reference
    if stamp_ns <= motion.anchor_ns:
        stamp_ns = motion.anchor_ns + 1  # it was on its way while the settings changed
    held = rolled(motion, stamp_ns, timeout_ns)
    if positions is None or not motion.counted or sample.source != motion.source:
        return Evidence(timeout_ns, stamp_ns, held, held, False, True)
    left, right = positions[0] - reference[0], positions[1] - reference[1]
    return Evidence(timeout_ns, stamp_ns, held, (left, right), True, (
        agree_within_rounding(held[0], left, positions[0], reference[0])
        and agree_within_rounding(held[1], right, positions[1], reference[1])))


def agree_within_rounding(held: float, measured: float, position: float, reference: float) -> bool:
    """
    Tell whether two angles differ by no more than what rounding of the positions makes.

    Parameters
    ----------
    held : float
        Angle by the rates held [rad].
    measured : float
        ``position - reference`` [rad].
    position, reference : float
        Positions of the wheel at the end and at the start [rad].

    Returns
    -------
    bool
        Whether the positions say what the rates do.

    Examples
    --------
    >>> agree_within_rounding(0.5, 7.5 - 7.0, 7.5, 7.0)
    True
    >>> agree_within_rounding(0.5, 7.5 - 7.1, 7.5, 7.1)
    False

    """
    return abs(held - measured) <= 4.0 * math.ulp(max(abs(position), abs(reference)))
