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

"""What all tests share: reproducible property tests, and a ROS domain for each ROS test."""

import os
import signal

os.environ['ROS_PYTHON_CHECK_FIELDS'] = '1'  # before any message type is imported

signal.signal(signal.SIGHUP, signal.SIG_DFL)  # also where all of it is started by nohup

from hypothesis import settings  # noqa: E402, I100
import pytest  # noqa: E402

STARTING = {'graph', 'machines', 'outside'}  # fixtures that start ROS processes

settings.register_profile('ci', derandomize=True, deadline=None)
settings.register_profile('quick', settings.get_profile('ci'), max_examples=25)
settings.load_profile('ci')

pytest_plugins = ['diffdrive_kinematics.testing.plugin']  # also where it is not installed


def pytest_configure(config):
    """Draw fewer examples of a law where slow tests are left out."""
    if 'not slow' in config.option.markexpr:
        settings.load_profile('quick')


@pytest.hookimpl(tryfirst=True)  # before pytest looks at the marks
def pytest_collection_modifyitems(items):
    """Mark as slow what starts ROS processes, and all but the first case of a test."""
    seen = set()
    for item in items:
        if 'here' in item.fixturenames:
            item.add_marker('ros')
        starts = STARTING & {*item.fixturenames}
        if starts:
            item.add_marker('ros')
            item.add_marker('processes')
        test = item.nodeid.partition('[')[0]
        if (starts or test in seen) and not item.get_closest_marker('quick'):
            item.add_marker('slow')
        seen.add(test)


@pytest.fixture
def graph():
    """Yield a graph in a domain of its own, and end its processes whatever happens."""
    from support.domains import own_domain
    from support.graph import Graph
    with own_domain() as domain:
        graph = Graph(domain)
        try:
            yield graph
        finally:
            graph.close()


@pytest.fixture
def here(capfd, monkeypatch):
    """Return what runs an executable in this process: one of its own takes two seconds more."""
    from support.inside import Run
    monkeypatch.setenv('RCUTILS_COLORIZED_OUTPUT', '0')
    return lambda name, args: Run(name, args, capfd)
