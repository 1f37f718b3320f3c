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
One stage of a forward projection: mean travel of the wheels, and bounds of its disturbances.

Stages that follow each other about one resting wheel are rotations about one point, and one stage.
"""

import math
from typing import NamedTuple, Sequence, Tuple, Union

from diffdrive_kinematics.core.kinematics import (
    check_finite, pose_change_from_travel, WheelGeometry)
from diffdrive_kinematics.core.noise.body_slip import body_noise, BodySlip, NO_BODY_SLIP
from diffdrive_kinematics.core.noise.distributions import unit_bound
from diffdrive_kinematics.core.noise.noise import travel_variance, WheelSlip
from diffdrive_kinematics.core.noise.step_noise import lateral_variances

NEGLIGIBLE = 1e-8
"""Travel [m] of a wheel that rests: what rounding leaves of it, and the slip of that."""


class Stage(NamedTuple):
    """
    Mean travel of the wheels in one stage, and bounds of its disturbances.

    Parameters
    ----------
    d_left, d_right : float
        Mean travel of the wheels [m].
    left_bound, right_bound : float
        By how much [m] it may be off.
    lateral_bound : float
        By how much [m] the robot may be displaced sideways.
    distance_bound : float
        By how much [m] the travel of the centre may be off beside what the wheels make of it.
    turn_bound : float
        By how much [rad] the turn may be off, likewise.

    Examples
    --------
    See :func:`stage_from_slip`.

    """

    d_left: float
    d_right: float
    left_bound: float
    right_bound: float
    lateral_bound: float = 0.0
    distance_bound: float = 0.0
    turn_bound: float = 0.0


def stage_from_slip(
        d_left: float, d_right: float, geometry: WheelGeometry, left_slip: WheelSlip,
        right_slip: WheelSlip, body: BodySlip = NO_BODY_SLIP) -> Stage:
    """
    Return the stage whose box holds every sample that ``propagate`` draws for a travel.

    Parameters
    ----------
    d_left, d_right : float
        Nominal travel of the wheels [m].
    geometry : WheelGeometry
        Distance of the wheels.
    left_slip, right_slip : WheelSlip
        Bias and slip of the wheels.
    body : BodySlip
        What slips beside the wheels.

    Returns
    -------
    Stage
        Mean travel with the bias, and the bounds of the slip.

    Raises
    ------
    ValueError
        If a slip that is not 0 has an unbounded distribution, or a travel is not finite.

    Examples
    --------
    A uniform density of variance ``s^2`` ends at ``sqrt(3) s``:

    >>> slip = WheelSlip(bias=0.5, variance=3e-4, distribution='uniform')
    >>> stage = stage_from_slip(1.0, 1.0, WheelGeometry(0.5, 0.125), slip, WheelSlip())
    >>> stage.d_left, round(stage.left_bound, 6), stage.d_right, stage.right_bound
    (1.5, 0.03, 1.0, 0.0)

    """
    check_finite('d_left', d_left)
    check_finite('d_right', d_right)
    lateral = lateral_variances(d_left, d_right, geometry, left_slip, right_slip)
    left, right = (1.0 + left_slip.bias) * d_left, (1.0 + right_slip.bias) * d_right
    stage = Stage(
        left, right,
        _bound('left wheel', left_slip, math.sqrt(travel_variance(left_slip, d_left))),
        _bound('right wheel', right_slip, math.sqrt(travel_variance(right_slip, d_right))),
        _bound('left wheel', left_slip, math.sqrt(lateral[0]))
        + _bound('right wheel', right_slip, math.sqrt(lateral[1])))
    if not body:
        return stage
    along, half_turn, aside = (
        _bound('body', body, float(stddev)) for stddev in body_noise(
            body, *pose_change_from_travel(geometry, left, right))[:3])
    return stage._replace(
        lateral_bound=stage.lateral_bound + aside, distance_bound=along,
        turn_bound=2.0 * half_turn)


def with_pivots_joined(
        stages: Sequence[Stage], geometry: WheelGeometry) -> Tuple[Sequence[Stage], float]:
    """
    Return the stages, those that follow each other about one resting wheel as one stage.

    Their rotations have one centre, so angles and bounds add up.  Where the body slips no wheel
    rests.

    Parameters
    ----------
    stages : sequence of Stage
        The stages, at least one.
    geometry : WheelGeometry
        Distance of the wheels.

    Returns
    -------
    joined : sequence of Stage
        As many or fewer.
    margin : float
        By how much [m] the end may be off, as what the resting wheel moved after all is left
        out: that displaces the robot, and turns it in front of all that follows.

    Examples
    --------
    >>> stage = Stage(0.0, 0.5, 0.0, 0.125)
    >>> (joined,), margin = with_pivots_joined([stage, stage], WheelGeometry(0.5, 0.125))
    >>> joined[:4], margin
    ((0.0, 1.0, 0.0, 0.25), 0.0)

    """
    joined, left_out = [stages[0]], 0.0
    for stage in stages[1:]:
        before = joined[-1]
        rigid = not any((*before[5:], *stage[5:]))
        for still in (_without_left, _without_right) if rigid else ():
            if max(_moved(before, still(before)), _moved(stage, still(stage))) <= NEGLIGIBLE:
                left_out += _moved(before, still(before)) + _moved(stage, still(stage))
                joined[-1] = Stage(*map(sum, zip(still(before), still(stage))))
                break
        else:
            joined.append(stage)
    reach = sum(abs(stage.d_left) + abs(stage.d_right) + sum(stage[2:]) for stage in stages)
    return joined, left_out * (1.0 + 2.0 * reach / geometry.separation)


def _without_left(stage: Stage) -> Stage:
    return stage._replace(d_left=0.0, left_bound=0.0, lateral_bound=0.0)


def _without_right(stage: Stage) -> Stage:
    return stage._replace(d_right=0.0, right_bound=0.0, lateral_bound=0.0)


def _moved(stage: Stage, other: Stage) -> float:
    """Return the most [m] by which a wheel, or the robot to the side, moves in one stage only."""
    return sum(abs(one - another) for one, another in zip(stage, other))


def _bound(what: str, slip: Union[WheelSlip, BodySlip], stddev: float) -> float:
    if stddev == 0.0:
        return 0.0
    bound = unit_bound(slip.distribution)
    if not math.isfinite(bound):
        raise ValueError(
            f'distribution of the {what} is {slip.distribution!r}, expected a bounded one')
    return bound * stddev
