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

__all__ = ['THIS_SESSION_ONLY', 'session_parameters', 'session_remark', 'session_rows']

THIS_SESSION_ONLY = (
    'the standard errors speak of this session only: what differs between sessions takes three '
    'or more drives that each tell the wheels, best of different days')
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
            f'errors of each; drives of one day tell nothing about other days{kept}')


def session_parameters(sessions: Optional[SessionFit]) -> Dict[str, float]:
    """Return the parameters to write; none where nothing is known of other sessions."""
    return {name.split()[0]: value for name, value, _ in session_rows(sessions)}
