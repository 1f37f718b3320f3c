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

"""What ``calibrate`` says and writes of what differs between runs."""

from typing import Dict, List, Optional, Tuple

from diffdrive_kinematics.core.calibration import SessionFit
from diffdrive_kinematics.core.noise import check_session_fraction

THIS_SESSION_ONLY = (
    'the standard errors hold for this session only: to find what differs between sessions, give '
    'three or more drives of which each is enough for the wheels, best of different days')
UNITS = {'scale': '1', 'separation': '1', 'curvature': 'rad/m'}


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
