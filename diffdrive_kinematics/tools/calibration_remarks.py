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

"""What a user should know of a calibration, in sentences, and what differs between its runs."""

import math
from typing import Dict, List, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration import (
    drift_pays, penalised, RecordedDrive, SessionFit, SlipFit, SquareFit, TrajectoryFit)
from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.core.noise import check_session_fraction
import numpy as np

KNOWN_BY_DRIVES = 'known from the drives: both radii and the separation'
KNOWN_BY_RATIO = (
    'known from the drives: the separation and the ratio of the radii; the mean radius is kept '
    'as it was')
PERIOD_S = 0.5
"""Time over which wheel motion is taken together: single ticks look like turns."""
FEWEST_TURNED = 0.2
"""Share of all turning that curves to one side should be at least."""
NO_SLIP_M = 1e-12
"""Slip variance [m] of runs that do not scatter at all."""
THIS_SESSION_ONLY = (
    'the standard errors hold for this session only: to find what differs between sessions, give '
    'three or more drives of which each is enough for the wheels, best of different days')
UNITS = {'scale': '1', 'separation': '1', 'curvature': 'rad/m'}


def square_remarks(fit: SquareFit, slip: float) -> List[str]:
    """Return what runs around a square tell, what they do not, and what the prediction is."""
    remarks = [
        'known from a square: the separation and the ratio of the radii; the mean radius is kept '
        'as it was: measure it along a straight']
    for name, kept, ratio, counts in (
            ('E_d', 'the radius multipliers stay', fit.umbmark.diameter_ratio,
             fit.diameters_count),
            ('E_b', 'wheel_separation_multiplier stays', fit.umbmark.separation_ratio,
             fit.separation_counts)):
        if not counts:
            remarks.append(
                f'{name}: no correction: {ratio.value:.5f} is within its error of 1, +- '
                f'{fit.quantile * ratio.error:.5f} (95 %): {kept} as before, more runs '
                'may show more')
    if slip < NO_SLIP_M:
        remarks.append(
            'warning: the runs of either way do not scatter: they show no slip, and all '
            'standard errors are too small; no slip is written; runs of a simulated robot need '
            'slip, and another seed each')
    return [*remarks, 'predicted: the root mean square in as many new runs; it counts the error '
            'of this estimate and the scatter of the new runs']


def frozen_remark(whole: Sequence[RecordedDrive], kept: Sequence[RecordedDrive]) -> List[str]:
    """Return how many poses of a tracker that hung were left out, if there are any."""
    number = sum(len(drive.reference) for drive in whole) - sum(
        len(drive.reference) for drive in kept)
    if not number:
        return []
    return [f'{number} poses of the reference were left out: they repeat the one before while '
            'the wheels turn (does the tracker hang?)']


def clock_remark(fit: TrajectoryFit) -> List[str]:
    """Return of which drives the reference's clock drifts, if that was chosen."""
    tried = [(number, ratio) for number, ratio in enumerate(fit.drift_ratios, start=1)
             if ratio is not None]
    if not tried:
        return []
    said = ', '.join(f'{number}: {ratio:.1f} ({"drift" if drift_pays(ratio) else "offset alone"})'
                     for number, ratio in tried)
    return ["the clock of a drive's reference has an offset, and a drift where the likelihood "
            f'ratio for it is over 6.6 (1 % by chance); ratio of drive {said}']


def slip_remark(slip: SlipFit) -> str:
    """Return which terms slip is made of, and why these."""
    said = f'slip is that of {_named(slip.terms)}'
    if not slip.rivals:
        return said
    best, *others = slip.rivals
    said += (': that of the wheels, or a likelier set: each constant has to raise twice the log '
             'likelihood by 6.6 (1 % by chance)')
    return said + ''.join(
        f'; next best: {_named(other.terms)}, {penalised(other) - penalised(best):.1f} behind'
        for other in others[:1])


def _named(terms: Sequence[str]) -> str:
    body = [term for term in terms if term != 'wheels']
    wheels = ['the wheels'] if 'wheels' in terms else []
    return ' and '.join(wheels + ([f'the body ({", ".join(body)})'] if body else []))


def frame_remark(fit: TrajectoryFit) -> List[str]:
    """Return a remark where the reference looks backwards."""
    if abs(fit.frame_yaw.value) <= 0.5 * math.pi:
        return []
    return [f'the reference looks backwards on the robot (yaw {fit.frame_yaw.value:.2f} rad): if '
            'it does not, left and right wheel are swapped or counted backwards']


def course_remarks(geometry: WheelGeometry, drives: Sequence[RecordedDrive]) -> List[str]:
    """Return what is missing in the courses: curves, or curves to one side."""
    steps = [np.diff(drive.angles[_first_rows(drive.time)], axis=0) for drive in drives]
    left, right = (np.concatenate(steps) * [geometry.left_radius, geometry.right_radius]).T
    turned = (right - left) / geometry.separation
    total = np.abs(turned).sum()
    if not total:
        return []
    curve = left * right > 0.0
    to_left, to_right = (np.maximum(way * turned, 0.0)[curve].sum() for way in (1.0, -1.0))
    if to_left + to_right < FEWEST_TURNED * total:
        return ['the drives turn almost only on the spot: drive curves to both sides as well, '
                'for better predictions in curves']
    for side, turning in (('left', to_left), ('right', to_right)):
        if turning < FEWEST_TURNED * (to_left + to_right):
            return [f'the drives have almost no curves to the {side}: drive some, as errors of '
                    'one side can hide in the wheels']
    return []


def _first_rows(time: np.ndarray) -> np.ndarray:
    """Return the first row of each period, shape (k,)."""
    return np.unique(np.floor((time - time[0]) / PERIOD_S), return_index=True)[1]


def session_rows(sessions: Optional[SessionFit]) -> List[Tuple[str, float, float]]:
    """Return name, value and standard error of each standard deviation between runs."""
    if sessions is None:
        return []
    return [(f'session_{name}_stddev [{unit}]', *getattr(sessions, name))
            for name, unit in UNITS.items() if getattr(sessions, name) is not None]


def session_remark(sessions: Optional[SessionFit]) -> str:
    """Return what is known of other sessions, in a line."""
    if sessions is None:
        return THIS_SESSION_ONLY
    kept = '; not the scale, as the mean radius is kept' if sessions.scale is None else ''
    return (f'session_*: what differs between the {sessions.sessions} drives beyond the standard '
            f'errors of each; drives of one day say nothing about other days{kept}'
            + ''.join(f'; WARNING: {name.split()[0]} is not written, as {value:.3g} is more than '
                      'the nodes take, look for a drive that is not like the others'
                      for name, value, _ in session_rows(sessions) if not _is_taken(name, value)))


def session_parameters(sessions: Optional[SessionFit]) -> Dict[str, float]:
    """Return the parameters to write, of those that are known what the nodes take."""
    return {name.split()[0]: value for name, value, _ in session_rows(sessions)
            if _is_taken(name, value)}


def _is_taken(name: str, value: float) -> bool:
    """Return whether the nodes take a standard deviation; fractions have a bound."""
    try:
        if name.endswith('[1]'):
            check_session_fraction(name, value)
    except ValueError:
        return False
    return True
