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

"""``web_view`` in a real browser: what drives, what stops, what is set and what is seen."""

import json
import os
import re
import shutil
import signal
import socket

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
from rcl_interfaces.srv import GetParameters
from support.graph import CONFIG, DEADLINE_S, KHEPERA, twist

BROWSER = shutil.which('chromium') or shutil.which('chromium-browser')
TRIES = 3
pytestmark = [pytest.mark.slow, pytest.mark.ros]


class Robot:
    """The robot of web.yaml, on a free port, and what it does."""

    def __init__(self, graph):
        self.graph = graph
        self.sim = graph.start('diffdrive_sim', args=[
            '--ros-args', '--params-file', str(CONFIG / 'web.yaml'), '-p', 'web_view:port:=0'])
        self.odometry = graph.collect(Odometry, 'odom')
        self.address = graph.wait_for(
            lambda: re.search(r'open (http://\S+)', self.sim.output), 'the page').group(1)

    def moves(self):
        return bool(self.odometry) and self.odometry[-1].twist.twist.linear.x != 0.0

    def rests(self):
        twist = self.odometry[-1].twist.twist
        return twist.linear.x == twist.angular.z == 0.0

    def wait(self, condition, what):
        return self.graph.wait_for(condition, what)

    def noise(self, name):
        return self.graph.call(
            GetParameters, 'wheel_noise/get_parameters',
            GetParameters.Request(names=[name])).values[0].double_value


@pytest.fixture
def robot(graph):
    pytest.importorskip('nicegui', reason="web_view needs '.[web]'")
    return Robot(graph)


@pytest.fixture
def browser():
    playwright = pytest.importorskip('playwright.sync_api', reason="a browser needs '.[browser]'")
    if not BROWSER:
        pytest.skip('chromium is not installed')
    with playwright.sync_playwright() as started:
        launched = started.chromium.launch(
            executable_path=BROWSER, args=['--no-sandbox'], timeout=1e3 * DEADLINE_S)
        yield launched
        if launched.is_connected():
            launched.close()


def seen(page, name):
    """Return what the page was told last."""
    return page.evaluate(f'webView.{name}')


def look(robot, browser, **options):
    return opened(browser, robot.address, **options)


def opened(browser, address, **options):
    """Return a page that is connected, and whose waits last as long as those of the graph."""
    page = browser.new_page(**options)
    page.set_default_timeout(1e3 * DEADLINE_S)
    page.goto(address)
    page.wait_for_function('window.webView && webView.lost === false')
    return page


def released(page):
    page.keyboard.up('w')


def hidden(page):
    page.evaluate("Object.defineProperty(document, 'hidden', {get: () => true});"
                  "document.dispatchEvent(new Event('visibilitychange'))")


def hung(page):
    """Let the scripts of the page get nowhere, with the connection as it is."""
    page.evaluate('() => { setTimeout(() => { for (;;) {} }, 0); }')


def left(page):
    page.goto('about:blank')


def killed(page):
    """Let the browser die without a word."""
    session = page.context.browser.new_browser_cdp_session()
    for process in session.send('SystemInfo.getProcessInfo')['processInfo']:
        try:
            os.kill(process['id'], signal.SIGKILL)
        except ProcessLookupError:
            pass


@pytest.mark.parametrize('end', [released, hidden, hung, left, killed])
def test_a_key_moves_the_robot_and_whatever_ends_it_lets_the_robot_rest(robot, browser, end):
    page = look(robot, browser)
    page.keyboard.down('w')
    robot.wait(robot.moves, 'the robot to move')
    end(page)
    robot.wait(robot.rests, 'the robot to rest')


def test_no_words_on_the_map_cover_others(robot, browser):
    page = look(robot, browser)
    page.keyboard.down('w')
    robot.wait(lambda: seen(page, 'truth'), 'the poses')
    page.evaluate('webView.notice = "emergency stop: nobody serves ~/stop, ".repeat(2)')
    page.wait_for_function('document.getElementById("dd-truth")?.textContent && document'
                           '.getElementById("dd-state").textContent.includes(webView.notice)')
    for width, height in (1280, 800), (701, 800), (390, 844):
        page.set_viewport_size({'width': width, 'height': height})
        legend, state, fit = (page.locator(each).bounding_box() for each in (
            '#dd-legend', '#dd-state', '#dd-fit'))
        assert legend['y'] + legend['height'] <= state['y']
        assert state['y'] + state['height'] <= fit['y']


def test_the_stick_drives_backward_and_turns(robot, browser):
    page = look(robot, browser, has_touch=True, viewport={'width': 390, 'height': 844})
    box = page.locator('#dd-pad').bounding_box()
    page.mouse.move(box['x'] + box['width'] / 2, box['y'] + box['height'] / 2)
    page.mouse.down()
    page.mouse.move(box['x'] + 0.2 * box['width'], box['y'] + 0.9 * box['height'])
    robot.wait(lambda: robot.moves() and robot.odometry[-1].twist.twist.linear.x < 0.0
               and robot.odometry[-1].twist.twist.angular.z > 0.0, 'a turn backward to the left')
    page.mouse.up()
    robot.wait(robot.rests, 'the robot to rest')


def test_the_emergency_stop_stands_until_it_is_released(robot, browser):
    page = look(robot, browser)
    page.keyboard.down('w')
    robot.wait(robot.moves, 'the robot to move')
    page.get_by_text('Emergency stop').click()
    robot.wait(robot.rests, 'the robot to rest')
    robot.wait(lambda: seen(page, 'stopped'), 'the page to say so')
    page.keyboard.up('w')
    page.keyboard.down('w')
    count = len(robot.odometry)
    robot.wait(lambda: len(robot.odometry) > count + 20, 'odometry')
    assert all(each.twist.twist.linear.x == 0.0 for each in robot.odometry[count:])
    page.get_by_text('Release').click()
    robot.wait(robot.moves, 'the robot to move')


def test_a_slider_sets_the_noise_and_all_viewers_see_it(robot, browser):
    first, second = look(robot, browser), look(robot, browser)
    knob = first.locator('#dd-left_bias [tabindex="0"]')
    robot.wait(lambda: first.get_by_text('0.01', exact=True).count(), 'the value of the node')
    knob.focus()
    before = robot.noise('left_bias')
    assert before == pytest.approx(0.01)
    for _ in range(5):  # at once, so before any of them is answered
        first.keyboard.press('ArrowRight')
    robot.wait(lambda: robot.noise('left_bias') == pytest.approx(before + 0.005), 'the bias')
    robot.wait(lambda: second.get_by_text('0.015', exact=True).count(), 'the other viewer')
    assert robot.odometry == [] or robot.rests()  # keys of a slider do not drive


def keep_drivers(page):
    """Let the page keep, as ``drivers``, all who it is told drive from now on."""
    page.evaluate("""() => {
        let driver = webView.driver;
        webView.drivers = [driver];
        Object.defineProperty(webView, 'driver', {configurable: true, get: () => driver,
            set: (told) => { driver = told; webView.drivers.push(told); }});
    }""")


def test_two_viewers_see_the_same_and_one_drives(robot, browser):
    first, second = look(robot, browser), look(robot, browser)

    def only_the_first_drives():
        """Press keys on both; return False where a first page that hung was let go."""
        first.keyboard.down('w')
        robot.wait(robot.moves, 'the robot to move')
        driver = robot.wait(lambda: seen(second, 'driver'), 'the driver')
        count = len(robot.odometry)
        keep_drivers(second)
        second.keyboard.down('s')
        robot.wait(lambda: len(robot.odometry) > count + 20, 'odometry')
        speeds = [each.twist.twist.linear.x for each in robot.odometry[count:]]
        if min(speeds) < 0.0:
            robot.wait(lambda: {*seen(second, 'drivers')} != {driver},
                       'the first one to be let go, before the second one drives')
        second.keyboard.up('s')
        first.keyboard.up('w')
        robot.wait(robot.rests, 'the robot to rest')
        return min(speeds) > 0.0

    assert any(only_the_first_drives() for _ in range(TRIES))
    robot.wait(lambda: seen(first, 'belief') == seen(second, 'belief')
               and seen(first, 'truth') == seen(second, 'truth'), 'the same robots')
    assert seen(first, 'truth')[:2] != seen(first, 'belief')[:2]
    second.keyboard.down('s')  # the helm is free
    robot.wait(lambda: robot.odometry[-1].twist.twist.linear.x < 0.0, 'the other one to drive')


def test_a_click_sends_the_robot_there_and_a_key_takes_it_back(robot, browser):
    page = look(robot, browser)
    page.keyboard.down('w')
    robot.wait(robot.moves, 'the robot to move')
    page.keyboard.up('w')
    robot.wait(robot.rests, 'the robot to rest')
    robot.wait(lambda: seen(page, 'belief'), 'the belief')
    box = page.locator('#dd-map').bounding_box()
    page.mouse.click(box['x'] + 0.8 * box['width'], box['y'] + 0.3 * box['height'])
    robot.wait(robot.moves, 'the robot to drive to the goal')
    page.keyboard.down('ArrowDown')
    robot.wait(lambda: robot.odometry[-1].twist.twist.linear.x < 0.0, 'the key to win')
    page.keyboard.up('ArrowDown')
    robot.wait(robot.rests, 'the robot to rest')
    robot.wait(lambda: 'an empty path came' in robot.sim.output, 'the report')


def test_reset_brings_belief_and_truth_back_to_the_start(robot, browser):
    page = look(robot, browser)
    page.keyboard.down('w')
    robot.wait(lambda: robot.moves() and robot.odometry[-1].pose.pose.position.x > 0.02, 'a way')
    page.keyboard.up('w')
    robot.wait(robot.rests, 'the robot to rest')
    page.get_by_text('Reset poses').click()
    robot.wait(lambda: robot.odometry[-1].pose.pose.position.x == 0.0, 'the start')
    robot.wait(lambda: (seen(page, 'truth') or [1.0])[0] == 0.0, 'the truth at the start')


def listens(graph):
    found = graph.node.get_subscriptions_info_by_topic('odom')
    return any(info.node_name == 'web_view' for info in found)


def test_nothing_is_subscribed_to_while_nobody_looks(robot, browser):
    graph = robot.graph
    assert not listens(graph)
    page = look(robot, browser)
    graph.wait_for(lambda: listens(graph), 'the page to listen')
    page.close()
    graph.wait_for(lambda: not listens(graph), 'the page to listen no longer')


def asked(address, request):
    """Return the first line that is answered to a request of a WebSocket."""
    host, port = re.match(r'http://([^:]+):(\d+)', address).groups()
    with socket.create_connection((host, int(port)), timeout=DEADLINE_S) as connection:
        connection.sendall(request.format(host=f'{host}:{port}').encode())
        return connection.recv(100).decode().splitlines()[0]


UPGRADE = ('GET /robot HTTP/1.1\r\nHost: {{host}}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n'
           'Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n'
           'Origin: {}\r\n\r\n')


@pytest.mark.parametrize('origin, answer', [
    ('http://{host}', '101'), ('http://elsewhere.example', '403'), ('null', '403')])
def test_pages_of_other_origins_do_not_drive(robot, origin, answer):
    assert asked(robot.address, UPGRADE.format(origin)).split()[1] == answer


def test_a_page_that_calls_this_machine_by_a_name_of_its_own_does_not_drive(robot):
    request = UPGRADE.format('http://{host}').replace('{host}', 'rebound.example:80')
    assert asked(robot.address, request).split()[1] == '403'


def test_a_second_page_on_the_same_port_is_refused_by_its_name(robot):
    port = int(robot.address.rsplit(':', 1)[1])
    second = robot.graph.start('web_view', {**KHEPERA, 'port': port})
    assert second.wait() == 2
    assert f'port is {port}' in second.output and 'Traceback' not in second.output


def test_without_nicegui_it_says_how_to_get_it(graph, tmp_path):
    (tmp_path / 'nicegui').mkdir()
    (tmp_path / 'nicegui' / '__init__.py').write_text('raise ImportError(name="nicegui")')
    page = graph.start('web_view', KHEPERA, environment={'PYTHONPATH': str(tmp_path)})
    assert page.wait() == 2
    assert 'nicegui is missing' in page.output and "pip install '.[web]'" in page.output


def test_what_is_no_command_is_counted_and_nothing_moves(robot, browser):
    page = look(robot, browser)
    for message in ('nonsense', json.dumps(['drive', [1]]), json.dumps(['drive', ['x', None]]),
                    json.dumps(['drive', [10**400, 0]]), json.dumps(['goal', [10**400, 0]]),
                    json.dumps(['set', ['left_bias', 10**400]]), json.dumps(['left', None]),
                    json.dumps(['set', ['robot_name', 1]]), json.dumps(['goal', [1e999, 0]]),
                    json.dumps(['unknown', 1]), json.dumps(3)):
        page.evaluate(f'new Promise((done) => {{const s = new WebSocket("{robot.address}/robot"'
                      f'.replace("http", "ws")); s.onopen = () => {{s.send({message!r});'
                      f' setTimeout(() => {{s.close(); done();}}, 200);}};}})')
    robot.wait(lambda: 'refused' in robot.sim.output, 'the report')
    page.keyboard.down('w')
    robot.wait(robot.moves, 'the robot to move')
    assert 'Traceback' not in robot.sim.output


def test_a_stop_that_nobody_serves_is_said_and_the_page_passes_nothing_on(graph, browser):
    pytest.importorskip('nicegui', reason="web_view needs '.[web]'")
    view = graph.start('web_view', {
        **KHEPERA, 'port': 0, 'autonomous_cmd_vel_topic': 'goal_cmd_vel'})
    address = graph.wait_for(
        lambda: re.search(r'open (http://\S+)', view.output), 'the page').group(1)
    commands = graph.collect(Twist, 'cmd_vel')
    autonomous = graph.publisher(Twist, 'goal_cmd_vel')

    def passed_on():
        autonomous.publish(twist(0.1, 0.0))
        return commands and commands[-1].linear.x == 0.1

    graph.wait_for(passed_on, 'what is passed on')
    page = opened(browser, address)
    page.get_by_text('Emergency stop').click()
    graph.wait_for(lambda: 'nobody serves' in view.output, 'the report')
    graph.wait_for(lambda: 'nobody serves' in (seen(page, 'notice') or ''), 'the notice')
    graph.wait_for(lambda: commands[-1].linear.x == 0.0, 'the rest')
    count = len(commands)
    graph.wait_for(lambda: passed_on() or len(commands) > count + 10, 'more commands')
    assert all(each.linear.x == 0.0 for each in commands[count:])
