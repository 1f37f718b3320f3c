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

"""The tutorials for newcomers: their commands run as they are written, and say what they say."""

import csv
from pathlib import Path
import re
import shlex
import signal
import subprocess
import sys

from diffdrive_kinematics.ros.parameters.package_share import share_directory
import pytest

ROOT = Path(__file__).parents[2]
FIRST, PAGE = ((ROOT / 'docs' / 'tutorial' / f'{name}.md').read_text(encoding='utf-8')
               for name in ('first_robot', 'without_ros_tools'))
ADDED = {  # to the commands with these files
    'config/web.yaml': ['-p', 'web_view:port:=0'],  # a free one: another test may have the usual
    'config/recording.yaml': ['-p', 'real_time_factor:=0.0']}  # not in the time that it took


def blocks(language, page=PAGE):
    """Return the blocks of a page in a language, in order."""
    found = re.findall(rf'^```{language}\n(.*?)^```$', page, re.M | re.S)
    return [block.replace('\\\n', ' ') for block in found]


@pytest.mark.timeout(900)  # a dozen of them
def test_the_commands_of_the_tutorial_run_as_they_are_written(graph, tmp_path):
    pytest.importorskip('matplotlib')
    pytest.importorskip('nicegui')
    (tmp_path / 'config').symlink_to(share_directory() / 'config')
    script, = blocks('python')
    (tmp_path / 'plot_drift.py').write_text(script, encoding='utf-8')
    install, *commands = map(shlex.split, blocks('bash'))
    assert install[:4] == ['python3', '-m', 'venv', '.venv']
    said = {}
    for words in commands:
        name = words[0].removeprefix('.venv/bin/')
        if name == 'python':
            subprocess.run([sys.executable, *words[1:]], cwd=tmp_path, check=True,
                           env={**graph._environment, 'MPLBACKEND': 'Agg'})
            continue
        added = [part for file, parts in ADDED.items() if file in words for part in parts]
        process = graph.start(name, args=[*words[1:], *added], cwd=tmp_path)
        if 'config/web.yaml' in words:
            graph.wait_for(lambda: 'to drive; Ctrl-C ends' in process.output, 'the page')
            process.send(signal.SIGINT)
        assert process.wait() == 0, process.output
        assert '[WARN]' not in process.output and '[ERROR]' not in process.output
        said[words[-1]] = process.output
    for name in re.findall(r'^Open `(\S+)`', PAGE, re.M) + re.findall(
            r'(\w+\.(?:csv|png|yaml))', ' '.join(word for words in commands for word in words)):
        assert any(tmp_path.rglob(name)) or (tmp_path / 'config' / name).exists(), name
    told(tmp_path, '\n'.join(said.values()))


def told(directory, said):
    """See that what was said has the rows that the page shows, and the columns it names."""
    for shown in blocks('text'):
        for line in shown.splitlines():
            if not line.startswith('recorded'):
                assert line.split() in [each.split() for each in said.splitlines()], line
    with open(directory / 'demo.csv', newline='', encoding='utf-8') as file:
        columns = next(csv.reader(file))
    assert all(f'`{column}`' in PAGE for column in columns)
    measured = [float(each) for each in re.findall(r'E_max,syst \[mm\] +(\S+)', said)]
    assert measured[0] > 150.0 and measured[1] < measured[0] / 10.0


def test_a_first_robot_drives_as_its_tutorial_says(graph, tmp_path):
    _, demo, plain, *compensated = blocks('bash', FIRST)
    robot, composed, awaited, noise = blocks('yaml', FIRST)
    noisy = re.sub(r'^    nodes: .*\n', composed, robot, flags=re.M)
    noisy = re.sub(r'^    wait_for_topics: .*\n', awaited, noisy, flags=re.M) + noise
    files = robot, robot, noisy, noisy, noisy
    for command, file, shown in zip(
            (demo, plain, plain, *compensated), files, blocks('text', FIRST), strict=True):
        (tmp_path / 'first_robot.yaml').write_text(file, encoding='utf-8')
        _, *args = shlex.split(command)
        process = graph.start(
            'diffdrive_sim', args=[*(args or ['--ros-args']), '-p', 'real_time_factor:=0.0'],
            cwd=tmp_path)
        assert process.wait() == 0, process.output
        said = [each.split() for each in process.output.splitlines()]
        for line in shown.splitlines():
            assert line.split() in said, process.output


def test_the_pictures_of_the_readme_are_there():
    readme = (ROOT / 'README.md').read_text(encoding='utf-8')
    pictures = re.findall(r'!\[[^]]+\]\((\S+)\)', readme)
    assert len(pictures) == 2
    assert all((ROOT / picture).is_file() for picture in pictures)
