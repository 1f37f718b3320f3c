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

"""A command that is obeyed once, on a machine that may hold up whoever sends or hears it."""

import math
import time

OLD = 's old, cmd_vel_timeout is'
PATIENCE_S = 1.5  # a node reports at most once a second that a command was too old


def obeyed_once(process, send):
    """Return what sends a command when it is called, and again only where it came too late."""
    sent, sent_at = 0, -math.inf

    def ask():
        nonlocal sent, sent_at
        if time.monotonic() > sent_at + PATIENCE_S and process.output.count(OLD) == sent:
            send()
            sent, sent_at = sent + 1, time.monotonic()

    return ask
