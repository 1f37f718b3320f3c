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

"""
Drive the demo's course again and again in fast mode, and watch the memory of the process.

``python test/benchmark/soak.py [--minutes N] [--warm-up N] [--bound KB]``

The whole graph of the demo runs in one process, looped, as fast as it can.  After the warm-up
the resident memory may not grow by more than the bound; status 1 where it does.
"""

import argparse
import os
from pathlib import Path
import re
import select
import signal
import subprocess
import sys
import tempfile
import time

COMMAND = 'from diffdrive_kinematics.executables import diffdrive_sim; diffdrive_sim()'
LOOK_S = 1.0


def resident_kb(pid):
    """Return the resident memory [kB] of a process."""
    return int(re.search(r'VmRSS:\s+(\d+)', Path(f'/proc/{pid}/status').read_text())[1])


def soaked(minutes, warm_up_minutes):
    """Return the memory [kB] once a second after the warm-up, the laps, and processor seconds."""
    log = tempfile.TemporaryFile(mode='w+')
    sim = subprocess.Popen(
        [sys.executable, '-c', COMMAND, '--ros-args', '-p', 'real_time_factor:=0.0',
         '-p', 'loop:=true'],
        stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
        env={**os.environ, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'})
    began, looks = time.monotonic(), []
    try:
        while (passed := time.monotonic() - began) < 60.0 * (minutes + warm_up_minutes):
            if sim.poll() is not None:
                log.seek(0)
                raise SystemExit(f'diffdrive_sim ended:\n{log.read()}')
            if passed > 60.0 * warm_up_minutes:
                looks.append(resident_kb(sim.pid))
            select.select([], [], [], LOOK_S)
        cpu = Path(f'/proc/{sim.pid}/stat').read_text().rpartition(')')[2].split()
        sim.send_signal(signal.SIGINT)
        status = sim.wait(30)
    finally:
        if sim.poll() is None:
            sim.kill()
            sim.wait()
    if status:
        raise SystemExit(f'diffdrive_sim ended with status {status}')
    log.seek(0)
    laps = sum(line.startswith('    0.0 of') for line in log)
    return looks, laps, (int(cpu[11]) + int(cpu[12])) / os.sysconf('SC_CLK_TCK')


def main():
    """Soak, and judge."""
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[1])
    parser.add_argument('--minutes', type=float, default=20.0)
    parser.add_argument('--warm-up', type=float, default=0.25, help='[min]')
    parser.add_argument('--bound', type=float, default=1024.0, help='[kB]')
    options = parser.parse_args()
    looks, laps, cpu_s = soaked(options.minutes, options.warm_up)
    first, last = looks[0], looks[-1]
    print(f'{laps} laps of the course, {cpu_s:.0f} s of processor time; {len(looks)} looks in '
          f'{options.minutes:g} min after a warm-up of {options.warm_up:g} min')
    print(f'resident memory: {first} kB at first, {max(looks)} kB at most, {last} kB at last: '
          f'grew by {last - first} kB, at most {options.bound:g} kB allowed')
    return 1 if laps < 2 or last - first > options.bound else 0


if __name__ == '__main__':
    sys.exit(main())
