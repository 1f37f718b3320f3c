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

"""The error with which a node refuses to start."""

from contextlib import contextmanager
from typing import Iterator


class ConfigurationError(Exception):
    """Parameters with which a node refuses to start; the text says what to set."""


@contextmanager
def refusing(node: str = '') -> Iterator[None]:
    """Take each ``ValueError`` for one of a parameter, with which a node of this name ends."""
    try:
        yield
    except ValueError as error:
        raise ConfigurationError(
            f'{node} refuses to start: {error}' if node else str(error)) from error
