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

"""What is said of several publishers of a topic, whose names come later than they do."""

from types import SimpleNamespace

from diffdrive_kinematics.ros.inputs.publisher_watch import PATIENCE, PublisherWatch
from diffdrive_kinematics.ros.inputs.wheel_watch import WheelWatch


class Discovery:
    """A node whose middleware finds the publishers of a topic; their names come later."""

    def __init__(self, *names):
        self.names, self.warnings = [*names], []
        self.runtime = SimpleNamespace(every=lambda rate, look: setattr(self, 'look', look))
        self.watch = PublisherWatch(
            self, 'cmd_vel', SimpleNamespace(get_publisher_count=lambda: len(self.names)), 'stop')

    def resolve_topic_name(self, name):
        return f'/{name}'

    def get_publishers_info_by_topic(self, topic):
        return [SimpleNamespace(node_namespace='/' if name else '_NODE_NAMESPACE_UNKNOWN_',
                                node_name=name or '_NODE_NAME_UNKNOWN_') for name in self.names]

    def get_logger(self):
        return SimpleNamespace(warning=self.warnings.append, info=lambda words: None)


def test_the_report_of_two_publishers_waits_for_their_names():
    node = Discovery('test', '')
    node.look()
    assert not node.warnings and not node.watch.problems()
    node.names[1] = 'teleop'
    node.look()
    node.look()
    assert node.warnings == ["2 publishers of '/cmd_vel' (/teleop, /test): stop"]
    assert [each.message for each in node.watch.problems()] == node.warnings


def test_a_publisher_whose_name_never_comes_is_reported_without_one():
    node = Discovery('test', '')
    for _ in range(PATIENCE + 1):
        assert not node.warnings
        node.look()
    assert node.warnings == ["2 publishers of '/cmd_vel' (/test, a node without a name): stop"]


def test_looks_for_the_name_of_a_publisher_that_has_gone_do_not_count_for_the_next_one():
    node = Discovery('test', '')
    for _ in range(PATIENCE - 1):
        node.look()
    node.names.pop()
    node.look()
    node.names.append('')
    for _ in range(PATIENCE):
        node.look()
        assert not node.warnings
    node.names[1] = 'teleop'
    node.look()
    assert node.warnings == ["2 publishers of '/cmd_vel' (/teleop, /test): stop"]


def test_the_count_does_not_wait_for_names_nor_are_those_of_before_said_with_it():
    node = Discovery('test', 'teleop')
    node.look()
    node.names.append('')
    node.look()
    assert node.watch.count == 3 and len(node.warnings) == 1
    assert [each.message for each in node.watch.problems()] == [
        "3 publishers of '/cmd_vel': stop"]
    node.names[2] = 'page'
    node.look()
    assert node.warnings[1:] == ["3 publishers of '/cmd_vel' (/page, /teleop, /test): stop"]
    assert [each.message for each in node.watch.problems()] == node.warnings[1:]


def test_looks_for_names_begin_anew_where_wheel_motion_is_contested_anew():
    node, contested = Discovery('driver', ''), [True]
    gathering = SimpleNamespace(
        sources=SimpleNamespace(contested=lambda now_ns: contested[0]), waiting_since_ns=None,
        delays=lambda: None, left_out=0, disagreements=list, incomplete=0)
    node.runtime.now_ns = int
    watch = WheelWatch(node, SimpleNamespace(gathering=gathering), 'wheel_rates')
    for _ in range(PATIENCE - 1):
        node.look()
    contested[0] = False
    node.look()
    contested[0] = True
    for _ in range(PATIENCE):
        node.look()
        assert not node.warnings and not watch.problems()
    node.names[1] = 'other'
    node.look()
    assert '(it is published by /driver, /other)' in node.warnings[0]
    assert [each.message for each in watch.problems()] == node.warnings
