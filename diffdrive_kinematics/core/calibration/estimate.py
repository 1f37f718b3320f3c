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

"""An estimated number with its standard error."""

from typing import NamedTuple


class Estimate(NamedTuple):
    """
    An estimated value with its standard error.

    Parameters
    ----------
    value : float
        What was estimated, or given.
    error : float
        Its standard error, in the same unit; 0 where the value was given.

    Examples
    --------
    >>> f'{Estimate(0.2013, 0.0004).value:.3f} m'
    '0.201 m'

    """

    value: float
    error: float
