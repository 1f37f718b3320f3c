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

"""The thread that wakes executors after a step of the wall clock: only where they need it."""

import shutil
import subprocess
import threading

from diffdrive_kinematics.ros.runtime import clock_step_guard
from diffdrive_kinematics.ros.runtime.clock_step_guard import ClockStepGuard, waits_on_wall_clock
import pytest

COMPILER = shutil.which('cc')


@pytest.mark.skipif(COMPILER is None, reason='no C compiler (cc) to build libraries')
@pytest.mark.parametrize('calls, expected', [
    ('pthread_cond_timedwait', True), ('pthread_cond_clockwait', False),
    ('pthread_cond_timedwait pthread_cond_clockwait', False), ('', False)],
    ids=['old glibc', 'new glibc', 'both', 'no wait'])
def test_a_library_waits_on_the_wall_clock_where_it_knows_no_other_wait(
        tmp_path, calls, expected):
    source, library = tmp_path / 'wait.c', tmp_path / 'librmw_wait.so'
    names = calls.split()
    body = ' + '.join(f'{name}()' for name in names) or '0'
    source.write_text(''.join(f'extern int {name}(void);\n' for name in names)
                      + f'int wait_for_it(void) {{ return {body}; }}\n')
    subprocess.run([COMPILER, '-shared', '-fPIC', '-o', library, source], check=True)
    assert waits_on_wall_clock(library) == expected


@pytest.mark.parametrize('needed', [True, False])
def test_the_thread_is_there_where_it_is_needed_and_is_gone_afterwards(monkeypatch, needed):
    monkeypatch.setattr(clock_step_guard, '_is_needed', lambda: needed)
    before = threading.active_count()
    with ClockStepGuard(None):
        assert threading.active_count() == before + needed
    assert threading.active_count() == before
