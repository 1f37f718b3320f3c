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

"""What a controller says of commands that come and are not obeyed."""

from diffdrive_kinematics.nodes.diff_drive_controller import DiffDriveController
from diffdrive_kinematics.ros.runtime.diagnostics import RateSample
import pytest
from std_msgs.msg import Bool
from support.graph import KHEPERA, twist, twist_stamped
from support.inside import inside, START_NS

pytestmark = pytest.mark.ros
S = 10**9
PLAIN = {**KHEPERA, 'emergency_stop_topic': 'stop'}
STAMPED = {**PLAIN, 'enable_stamped_cmd_vel': True}


@pytest.mark.parametrize('parameters, stopped, command', [
    (PLAIN, True, lambda now_ns: twist(0.1, 0.0)),
    (STAMPED, True, lambda now_ns: twist_stamped(now_ns, 0.1, 0.0)),
    (STAMPED, False, lambda now_ns: twist_stamped(now_ns - 3 * S, 0.1, 0.0)),
    (PLAIN, False, lambda now_ns: twist(float('nan'), 0.0)),
], ids=['stopped', 'stopped, stamped', 'old', 'not finite'])
def test_commands_that_are_not_obeyed_are_heard(parameters, stopped, command):
    """The status does not say that nothing is: whoever reads that looks for a broken link."""
    with inside(DiffDriveController, parameters) as held:
        if stopped:
            held.hear('/stop', Bool(data=True))
        for second in range(1, 4):
            now_ns = START_NS + second * S
            held.advance_to(now_ns)
            held.hear('/cmd_vel', command(now_ns))
            values, problems = held.node.status(RateSample(now_ns))
            assert values['command messages'] == second
            assert not [each for each in problems if 'no messages' in each.message]
        _, problems = held.node.status(RateSample(now_ns + 2 * S))  # then nothing comes
        assert [each for each in problems if 'no messages' in each.message]
