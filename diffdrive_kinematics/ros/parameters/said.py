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

"""What was said in a process, to say it once."""

from typing import Any, Set
import weakref

_said: 'weakref.WeakKeyDictionary[Any, Set[str]]' = weakref.WeakKeyDictionary()


def is_new(node: Any, what: str) -> bool:
    """Return whether no node of the process, which is its context, has asked this before."""
    said = _said.setdefault(node.context, set())
    new = what not in said
    said.add(what)
    return new
