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

"""A message about the wheels, and what becomes of it; pairs are (left, right)."""

from dataclasses import dataclass
import enum
from typing import Optional, Tuple

from diffdrive_kinematics.core.kinematics import is_sane, LARGEST

WheelPair = Tuple[float, float]
ZERO: WheelPair = (0.0, 0.0)


@dataclass(frozen=True)
class WheelSample:
    """
    One message about the wheels.

    Parameters
    ----------
    stamp_ns : int
        Its stamp [ns].
    rates : pair of float or None
        Wheel rates [rad/s]; None where absent.
    positions : pair of float or None
        Angles of the wheels [rad]; None where absent.
    source : str
        What tells one publisher from another, where it is known; see :func:`is_run`.

    Raises
    ------
    ValueError
        If both are absent, or a value is not finite or is absurdly large.

    Examples
    --------
    >>> WheelSample(0, rates=(1.0, 2.0)).positions is None
    True

    """

    stamp_ns: int
    rates: Optional[WheelPair]
    positions: Optional[WheelPair] = None
    source: str = ''

    def __post_init__(self) -> None:
        rates, positions = self.rates, self.positions
        if rates is None and positions is None:
            raise ValueError('velocity and position are absent, expected at least one of them')
        if rates is not None and not is_sane(*rates):
            raise _absurd('velocity', rates)
        if positions is not None and not is_sane(*positions):
            raise _absurd('position', positions)


def _absurd(name: str, pair: WheelPair) -> ValueError:
    return ValueError(
        f'{name} (left, right) is {pair!r}, expected finite numbers within +-{LARGEST:g}')


def is_run(source: str) -> bool:
    """
    Tell whether a source is one run of a publisher of this package.

    They have a ``#`` in it; anything else is what somebody else's driver takes for a frame.  Its
    positions count from anywhere, and its rates are what it makes of them.

    Parameters
    ----------
    source : str
        Of a sample.

    Returns
    -------
    bool
        Whether it has a ``#``.

    Examples
    --------
    >>> is_run('/simulated_base#1f3a'), is_run('base_link')
    (True, False)

    """
    return '#' in source


class Verdict(enum.Enum):
    """
    What became of a sample.

    Examples
    --------
    >>> Verdict.MOVED.value
    'moved'

    """

    FIRST = 'first'
    MOVED = 'moved'
    REPEATED = 'repeated'
    JUMPED = 'jump'
    OUT_OF_ORDER = 'out of order'
    CLOCK_STEP = 'clock step'
