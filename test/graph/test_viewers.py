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
"""The configurations of RViz and Foxglove name what the nodes of the demo really have."""

import json

from diffdrive_kinematics.core.kinematics import Command, Pose, poses_along
from nav_msgs.msg import Odometry
import pytest
from rclpy.qos import DurabilityPolicy
from support.graph import CONFIG
import yaml

KINDS = {
    'Odometry': 'nav_msgs/msg/Odometry', 'Path': 'nav_msgs/msg/Path',
    'PoseArray': 'geometry_msgs/msg/PoseArray', 'Polygon': 'geometry_msgs/msg/PolygonStamped',
    'RobotModel': 'std_msgs/msg/String'}
WITHOUT_TOPIC = {'Grid', 'TF'}
DRAWN_IN_3D = {*KINDS.values()} - {KINDS['Odometry']}  # by Foxglove
COMMON = {'Class', 'Enabled', 'Name', 'Value'}
TOPIC = {'Depth', 'Durability Policy', 'History Policy', 'Reliability Policy', 'Value'}
ARROW = {'Alpha', 'Color', 'Head Length', 'Head Radius', 'Shaft Length', 'Shaft Radius'}
AXES = {'Axes Length', 'Axes Radius'}
NARROW = {'rviz_common/Displays', 'rviz_common/Views'}  # a third of the window at most
BARS, BESIDE = 100, 400  # [pixels] of a window that menus and panels take at most
MARGIN = 0.1  # [m] from the robot's centre to the tip of its arrow
PROPERTIES = {  # of rviz_default_plugins' displays, by what they are in (None: the display)
    'Grid': {
        None: {'Alpha', 'Cell Size', 'Color', 'Line Style', 'Normal Cell Count', 'Offset', 'Plane',
               'Plane Cell Count', 'Reference Frame'},
        'Line Style': {'Line Width', 'Value'}, 'Offset': set('XYZ')},
    'RobotModel': {
        None: {'Alpha', 'Collision Enabled', 'Description File', 'Description Source',
               'Description Topic', 'TF Prefix', 'Update Interval', 'Visual Enabled'},
        'Description Topic': TOPIC},
    'TF': {
        None: {'Frame Timeout', 'Frames', 'Marker Scale', 'Show Arrows', 'Show Axes',
               'Show Names', 'Update Interval'},
        'Frames': {'All Enabled'}},
    'Odometry': {
        None: {'Angle Tolerance', 'Covariance', 'Keep', 'Position Tolerance', 'Shape', 'Topic'},
        'Covariance': {'Orientation', 'Position', 'Value'},
        'Covariance/Orientation': {
            'Alpha', 'Color', 'Color Style', 'Frame', 'Offset', 'Scale', 'Value'},
        'Covariance/Position': {'Alpha', 'Color', 'Scale', 'Value'},
        'Shape': {*ARROW, *AXES, 'Value'}, 'Topic': {*TOPIC, 'Filter size'}},
    'Path': {
        None: {'Alpha', 'Buffer Length', 'Color', 'Line Style', 'Line Width', 'Offset',
               'Pose Style', 'Topic'},
        'Offset': set('XYZ'), 'Topic': {*TOPIC, 'Filter size'}},
    'PoseArray': {
        None: {*ARROW, *AXES, 'Arrow Length', 'Shape', 'Topic'},
        'Topic': {*TOPIC, 'Filter size'}},
    'Polygon': {None: {'Alpha', 'Color', 'Topic'}, 'Topic': {*TOPIC, 'Filter size'}}}
POSES = 'arrowScale axisScale gradient lineWidth type visible'
READ = {  # by Foxglove in a panel's configuration; it says nothing of any other key
    '3D': {
        '': 'cameraState followMode followTf imageMode layers publish scene topics transforms',
        'cameraState': 'distance far fovy near perspective phi target targetOffset '
                       'targetOrientation thetaOffset',
        'scene': 'transforms',
        'scene.transforms': 'axisScale axisSize lineWidth showLabel',
        'topics./path': POSES, 'topics./ground_truth_path': POSES,
        'topics./projected_poses': POSES,
        'topics./projected_boundary': 'color lineWidth visible',
        'topics./robot_description': 'visible',
        'layers.grid': 'color divisions frameLocked instanceId label layerId lineWidth position '
                       'rotation size visible'},
    'Plot': {
        '': 'isSynced legendDisplay paths showLegend showXAxisLabels showYAxisLabels '
            'sidebarDimension xAxisVal',
        'paths': 'color enabled label showLine timestampMethod value'},
    'Teleop': {
        '': 'downButton leftButton publishRate rightButton topic upButton',
        'upButton': 'field value', 'downButton': 'field value', 'leftButton': 'field value',
        'rightButton': 'field value'},
    'DiagnosticSummary': {
        '': 'hardwareIdFilter minLevel pinnedIds sortByLevel topicToRender'}}
NODES = ['command_sequence', 'diff_drive_controller', 'wheel_noise', 'simulated_base',
         'simulated_base:ground_truth', 'forward_projection', 'robot_description']


def kind_of(display):
    return display['Class'].rpartition('/')[2]


def rviz():
    return yaml.safe_load((CONFIG / 'diffdrive.rviz').read_text())


def shown():
    """Return the settings of RViz's displays."""
    return rviz()['Visualization Manager']['Displays']


def colour(text, alpha=1.0, behind=(0, 0, 0)):
    """Return red, green and blue of RViz's text, over what is behind it."""
    return [alpha * int(one) + (1.0 - alpha) * other
            for one, other in zip(text.split(';'), behind)]


def contrast(one, other):
    """Return the contrast ratio of two colours (WCAG 2.1)."""
    def luminance(rgb):
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
                  for c in (value / 255.0 for value in rgb)]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def displays():
    """Return (class, topic settings) of RViz's displays with a topic."""
    assert {kind_of(display) for display in shown()} == {*KINDS, *WITHOUT_TOPIC}
    return [(kind_of(display), display.get('Description Topic') or display['Topic'])
            for display in shown() if kind_of(display) not in WITHOUT_TOPIC]


def panels():
    """Return the panels of Foxglove's layout, by name."""
    layout = json.loads((CONFIG / 'diffdrive_foxglove.json').read_text())

    def placed(part):
        return {part} if isinstance(part, str) else placed(part['first']) | placed(part['second'])

    assert placed(layout['layout']) == set(layout['configById'])
    return layout['configById']


def wanted():
    """Return (topic, types) of all that is shown or sent."""
    topics = [(topic['Value'], {KINDS[kind]}) for kind, topic in displays()]
    for name, panel in panels().items():
        kind = name.partition('!')[0]
        if kind == '3D':
            topics += [(topic, DRAWN_IN_3D) for topic in panel['topics']]
        elif kind == 'Plot':
            topics += [(path['value'].partition('.')[0], {KINDS['Odometry']})
                       for path in panel['paths']]
        elif kind == 'Teleop':
            topics.append((panel['topic'], {'geometry_msgs/msg/Twist'}))
        else:
            assert kind == 'DiagnosticSummary'
            topics.append((panel['topicToRender'], {'diagnostic_msgs/msg/DiagnosticArray'}))
    return topics


def properties(settings, above=None):
    """Yield (path of the settings above or None, names) of settings within settings."""
    yield above, set(settings)
    for name, value in settings.items():
        if isinstance(value, dict):
            yield from properties(value, name if above is None else f'{above}/{name}')


@pytest.fixture
def demo(graph):
    """Start the demo with all that can be shown; return the types of the topics."""
    graph.start('diffdrive_sim', {'real_time_factor': 1.0}, '-p', f'diffdrive_sim:nodes:={NODES}')
    names = {topic for topic, _ in wanted()}

    def types():
        found = dict(graph.node.get_topic_names_and_types())
        return names <= set(found) and found

    return graph.wait_for(types, f'all of {sorted(names)}')


def test_every_topic_that_is_shown_exists_and_has_the_type_that_the_display_takes(graph, demo):
    for topic, kinds in wanted():
        assert len(demo[topic]) == 1
        assert demo[topic][0] in kinds, topic
    graph.wait_for(  # discovery tells of names last
        lambda: [listener.node_name for listener in graph.node.get_subscriptions_info_by_topic(
            '/cmd_vel')] == ['diff_drive_controller'], 'the controller alone to hear /cmd_vel')


def test_a_display_asks_for_no_more_than_is_offered_and_for_what_is_kept(graph, demo):
    for _, topic in displays():
        (publisher,) = graph.wait_for(
            lambda: graph.node.get_publishers_info_by_topic(topic['Value']), topic['Value'])
        kept = publisher.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
        assert (topic['Durability Policy'] == 'Transient Local') == kept
        assert topic['Reliability Policy'] == 'Reliable'


def test_every_plotted_path_is_a_number_of_its_message():
    paths = [path['value'] for name, panel in panels().items() if name.startswith('Plot!')
             for path in panel['paths']]
    assert len(paths) == 4
    for path in paths:
        value = Odometry()  # as its topic has it
        for field in path.split('.')[1:]:
            value = getattr(value, field)
        assert isinstance(value, float)


@pytest.mark.parametrize('name', panels())
def test_the_viewer_reads_every_key_of_a_panel(name):
    for path, keys in READ[name.partition('!')[0]].items():
        part = panels()[name]
        for step in filter(None, path.split('.')):
            part = part[step]
        for settings in part if isinstance(part, list) else [part]:
            assert set(settings) <= set(keys.split()), path


def test_a_legend_covers_no_curve_and_leaves_the_plot_its_height():
    for name, panel in panels().items():
        if name.startswith('Plot!'):
            assert panel['showLegend']
            assert panel['legendDisplay'] == 'top'
            assert panel['sidebarDimension'] <= 28 * len(panel['paths'])  # pixels


def test_the_robot_is_a_topic_of_the_3d_panel_which_every_viewer_can_show_without_a_layer():
    panel = panels()['3D!diffdrive']
    assert panel['topics']['/robot_description'] == {'visible': True}
    assert {layer['layerId'] for layer in panel['layers'].values()} == {'foxglove.Grid'}


def test_the_3d_panel_is_to_the_scale_of_the_robot_and_the_course_of_the_demo():
    demo = yaml.safe_load((CONFIG / 'demo.yaml').read_text())
    robot = demo['/**']['ros__parameters']['wheel_separation']
    speed, _, duration = demo['/**/command_sequence']['ros__parameters']['commands'][:3]
    panel = panels()['3D!diffdrive']
    frames, camera = panel['scene']['transforms'], panel['cameraState']
    assert not frames['showLabel']  # 0.2 m high, unless set
    assert 0.3 * robot < 0.2 * frames['axisScale'] < robot  # an axis of scale 1 is 0.2 m long
    assert 0.3 * robot < frames['axisSize'] < robot  # its name in newer releases
    assert not camera['perspective']
    assert speed * duration + 2.0 * robot < camera['distance'] < 2.5 * speed * duration
    assert camera['targetOffset'][:2] == [0.5 * speed * duration] * 2


def test_teleop_repeats_its_command_before_the_controller_times_out():
    (teleop,) = (panel for name, panel in panels().items() if name.startswith('Teleop!'))
    assert teleop['publishRate'] > 2.0 / 0.5  # cmd_vel_timeout


@pytest.mark.parametrize('display', shown(), ids=lambda display: display['Name'])
def test_a_display_has_every_property_that_is_set_since_rviz_ignores_the_others(display):
    known = PROPERTIES[kind_of(display)]
    for above, found in properties(display):
        assert found <= known[above] | (COMMON if above is None else set()), above


def test_the_panels_leave_room_for_the_view():
    # Without a state of its main window RViz docks every panel at the left, as wide as the widest.
    assert {panel['Class'] for panel in rviz()['Panels']} <= NARROW
    for side in ('Left', 'Right'):  # a flag that is not set is read from memory that is not, too
        assert rviz()['Window Geometry'][f'Hide {side} Dock'] is False


def test_the_view_holds_the_course_of_the_demo_and_is_filled_by_it():
    values = yaml.safe_load((CONFIG / 'demo.yaml').read_text())
    numbers = iter(values['/**/command_sequence']['ros__parameters']['commands'])
    course = poses_along(Pose(0.0, 0.0, 0.0), map(Command, numbers, numbers, numbers))
    window, view = rviz()['Window Geometry'], rviz()['Visualization Manager']['Views']['Current']
    assert kind_of(view) == 'TopDownOrtho' and view['Angle'] == 0
    for room, centre, along in (
            (window['Width'] - BESIDE, view['X'], [pose.x for pose in course]),
            (window['Height'] - BARS, view['Y'], [pose.y for pose in course])):
        half = 0.5 * room / view['Scale']
        assert centre - half < min(along) - MARGIN and max(along) + MARGIN < centre + half
        assert max(along) - min(along) > 0.4 * 2.0 * half


def test_belief_and_truth_stand_out_from_the_ground_and_from_the_grid_that_lies_under_them():
    manager = rviz()['Visualization Manager']
    (grid,) = (display for display in shown() if kind_of(display) == 'Grid')
    ground = colour(manager['Global Options']['Background Color'])
    line = colour(grid['Color'], grid['Alpha'], ground)
    paths = [display for display in shown() if kind_of(display) == 'Path']
    for path in paths:
        assert min(contrast(colour(path['Color']), under) for under in (ground, line)) >= 3.0
        assert path['Line Style'] == 'Billboards'  # others are a pixel wide, as those of the grid
        assert path['Line Width'] * manager['Views']['Current']['Scale'] >= 2.0
    poses = [display['Shape'] for display in shown() if kind_of(display) == 'Odometry']
    assert [pose['Color'] for pose in poses] == [path['Color'] for path in paths]
    assert len({path['Color'] for path in paths}) == 2


def test_the_covariance_is_seen_through_the_robot_and_that_of_the_heading_at_the_arrow():
    (robot,) = (display for display in shown() if kind_of(display) == 'RobotModel')
    assert robot['Alpha'] <= 0.5  # the ellipse is on the ground under it, and smaller than it
    for display in shown():
        if kind_of(display) == 'Odometry':
            position, heading = (
                display['Covariance'][name] for name in ('Position', 'Orientation'))
            assert position['Scale'] == heading['Scale'] == 3  # as the file says
            arrow = display['Shape']
            assert heading['Offset'] == pytest.approx(arrow['Shaft Length'] + arrow['Head Length'])
