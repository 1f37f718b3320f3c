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

"""Silence after which wheels stop, and how far off stamps may be then."""

from typing import Optional

from diffdrive_kinematics.core.kinematics import NANOSECONDS

STEP_TOLERANCE_NS = 1_000_000_000
TOLERANCE_NS = 250_000_000


def timeout_from_seconds(seconds: float) -> Optional[int]:
    """
    Return a timeout in nanoseconds.

    Parameters
    ----------
    seconds : float
        The timeout [s]; 0: none.

    Returns
    -------
    int or None
        The timeout [ns]; None: none.

    Examples
    --------
    >>> timeout_from_seconds(0.5), timeout_from_seconds(0.0)
    (500000000, None)

    """
    return round(seconds * NANOSECONDS) if seconds else None


def step_tolerance(timeout_ns: Optional[int]) -> int:
    """
    Return how far a stamp may be off before it is taken for a step of the clock.

    Parameters
    ----------
    timeout_ns : int or None
        Silence after which the wheels stop [ns]; None: they do not.

    Returns
    -------
    int
        The timeout, and a second at least [ns].

    Examples
    --------
    >>> step_tolerance(None), step_tolerance(2_000_000_000)
    (1000000000, 2000000000)

    """
    return max(timeout_ns or 0, STEP_TOLERANCE_NS)


def tolerance_of(timeout_ns: Optional[int]) -> int:
    """
    Return how far stamps may be off where silence has a timeout: half of it.

    Parameters
    ----------
    timeout_ns : int or None
        The timeout [ns]; None: there is none.

    Returns
    -------
    int
        The tolerance [ns], a quarter of a second at most.

    Examples
    --------
    >>> tolerance_of(None), tolerance_of(100_000_000)
    (250000000, 50000000)

    """
    return TOLERANCE_NS if timeout_ns is None else min(TOLERANCE_NS, timeout_ns // 2)
