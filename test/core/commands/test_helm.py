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


"""Who of several viewers drives: one at a time, and nobody who is silent."""

from diffdrive_kinematics.core.commands import Helm
from hypothesis import given, strategies as st

TIMEOUT_S = 0.5
REST = (0.0, 0.0)
EVENTS = st.lists(st.tuples(
    st.integers(1, 3), st.sampled_from([REST, (0.3, 0.0), (0.0, -1.0), None]),
    st.floats(0.0, 1.0)), max_size=30)  # who, asks for what or leaves, after how long [s]


def after(helm, viewer, command, now_s):
    return helm.at(now_s).left(viewer) if command is None else helm.asked(viewer, command, now_s)


@given(EVENTS)
def test_a_robot_moves_only_as_its_viewer_asked_within_the_timeout(events):
    helm, now_s, asked = Helm(TIMEOUT_S), 100.0, {}
    for viewer, command, pause_s in events:
        now_s += pause_s
        helm = after(helm, viewer, command, now_s)
        asked[viewer] = command, now_s
        assert (helm.command == REST) == (helm.viewer == 0)
        if helm.viewer:
            said, when_s = asked[helm.viewer]
            assert helm.command == said and now_s - when_s <= TIMEOUT_S


@given(EVENTS)
def test_who_drives_is_not_changed_by_others_before_it_ends(events):
    helm, now_s = Helm(TIMEOUT_S), 100.0
    for viewer, command, pause_s in events:
        now_s += pause_s
        before = helm.at(now_s)
        helm = after(helm, viewer, command, now_s)
        assert helm == before or before.viewer in (0, viewer)


def test_a_silent_helm_is_free_for_the_next_viewer():
    helm = Helm(TIMEOUT_S).asked(1, (0.3, 0.0), 100.0)
    assert helm.at(100.0 + TIMEOUT_S).viewer == 1
    assert helm.asked(2, (-0.3, 0.0), 100.1 + TIMEOUT_S)[1:3] == (2, (-0.3, 0.0))
