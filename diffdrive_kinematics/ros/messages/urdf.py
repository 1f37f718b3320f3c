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
A differential-drive robot as URDF: a box on wheels that turn, from the geometry alone.

The base link is on the ground between the wheels, where odometry has it (REP-103: x forward, y
left, z up).  A wheel's joint has the radius as its height and y as its axis, so that a positive
angle rolls forward; an inverted joint has the opposite axis, as it tells the opposite angle.
Behind a gear the joint is that of the motor, and the joint of the wheel, with ``_wheel`` behind
the name, mimics it by the gear ratio.  The shapes are for looking at; there are no masses.
"""

from typing import List, NamedTuple, Tuple
from xml.etree import ElementTree

from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.ros.messages.wheel_joints import WheelJoints

GAP = 2.5  # wheels of a side and the ends of the body, in radii
UPRIGHT = '1.5707963267948966 0 0'  # the axis of a cylinder is z, that of a wheel y
BODY, TYRE, SPOKE = '0.2 0.4 0.8 1', '0.1 0.1 0.1 1', '0.9 0.9 0.9 1'


class Shape(NamedTuple):
    """Distance [m] from the first to the last wheel of a side, and width [m] of the wheels."""

    wheel_base: float
    wheel_width: float


class Wheel(NamedTuple):
    """Joint of a wheel, whether it is inverted, its gear, link, centre [m] and radius [m]."""

    joint: str
    inverted: bool
    gear_ratio: float
    link: str
    centre: Tuple[float, float, float]
    radius: float


def urdf_of(
        geometry: WheelGeometry, joints: WheelJoints, *,
        name: str, base: str, shape: Shape) -> str:
    """
    Return the URDF of a robot.

    Parameters
    ----------
    geometry : WheelGeometry
        Its effective radii and separation count.
    joints : WheelJoints
        Of the wheels of each side, from front to rear.
    name, base : str
        Of the robot, and of its base link; links of the wheels have what precedes the last '/'
        of the base link's name, as frames of one robot of several do.
    shape : Shape
        What the geometry does not tell.

    Returns
    -------
    str
        XML.

    """
    robot = ElementTree.Element('robot', name=name)
    _add_body(ElementTree.SubElement(robot, 'link', name=base), geometry, shape)
    half = 0.5 * geometry.separation
    prefix = base[:base.rfind('/') + 1]
    for names, inverted, y, radius in zip(
            joints.names, joints.inverted, (half, -half),
            (geometry.left_radius, geometry.right_radius)):
        for joint, x in zip(names, _spread(len(names), shape.wheel_base)):
            link = f"{prefix}{joint.rpartition('/')[2]}_link"
            wheel = Wheel(joint, inverted, joints.gear_ratio, link, (x, y, radius), radius)
            _add_wheel(robot, base, wheel, shape.wheel_width)
    ElementTree.indent(robot)
    return ElementTree.tostring(robot, encoding='unicode', xml_declaration=False) + '\n'


def default_wheel_base(geometry: WheelGeometry, wheels: int) -> float:
    """Return a distance [m] at which the wheels of a side do not touch."""
    return GAP * max(geometry.left_radius, geometry.right_radius) * (wheels - 1)


def _spread(count: int, length: float) -> List[float]:
    """Return places along x, from front to rear; a single one is in the middle."""
    if count == 1:
        return [0.0]
    return [length * (0.5 - i / (count - 1)) for i in range(count)]


def _add_body(link: ElementTree.Element, geometry: WheelGeometry, shape: Shape) -> None:
    radius = max(geometry.left_radius, geometry.right_radius)
    width = max(geometry.separation - 1.5 * shape.wheel_width, 0.2 * geometry.separation)
    _add_visual(link, 'body', BODY, _numbers(0.0, 0.0, 1.5 * radius), '0 0 0', 'box',
                size=_numbers(shape.wheel_base + GAP * radius, width, radius))


def _add_wheel(robot: ElementTree.Element, base: str, wheel: Wheel, width: float) -> None:
    if wheel.gear_ratio == 1.0:
        _add_joint(robot, base, wheel, wheel.joint, wheel.link)
    else:
        motor = f'{wheel.link}_motor'
        _add_joint(robot, base, wheel, wheel.joint, motor)
        ElementTree.SubElement(robot, 'link', name=motor)
        joint = _add_joint(robot, base, wheel, f'{wheel.joint}_wheel', wheel.link)
        ElementTree.SubElement(
            joint, 'mimic', joint=wheel.joint, multiplier=_numbers(1.0 / wheel.gear_ratio))
    link = ElementTree.SubElement(robot, 'link', name=wheel.link)
    _add_visual(link, 'tyre', TYRE, '0 0 0', UPRIGHT, 'cylinder',
                radius=_numbers(wheel.radius), length=_numbers(width))
    _add_visual(link, 'spoke', SPOKE, '0 0 0', '0 0 0', 'box', size=_numbers(
        1.8 * wheel.radius, 1.1 * width, 0.2 * wheel.radius))


def _add_joint(
        robot: ElementTree.Element, base: str, wheel: Wheel, name: str, link: str
) -> ElementTree.Element:
    joint = ElementTree.SubElement(robot, 'joint', name=name, type='continuous')
    ElementTree.SubElement(joint, 'parent', link=base)
    ElementTree.SubElement(joint, 'child', link=link)
    ElementTree.SubElement(joint, 'origin', xyz=_numbers(*wheel.centre), rpy='0 0 0')
    ElementTree.SubElement(joint, 'axis', xyz='0 -1 0' if wheel.inverted else '0 1 0')
    return joint


def _add_visual(
        link: ElementTree.Element, name: str, colour: str, xyz: str, rpy: str, shape: str,
        **size: str) -> None:
    visual = ElementTree.SubElement(link, 'visual')
    ElementTree.SubElement(visual, 'origin', xyz=xyz, rpy=rpy)
    ElementTree.SubElement(ElementTree.SubElement(visual, 'geometry'), shape, size)
    material = ElementTree.SubElement(visual, 'material', name=name)
    ElementTree.SubElement(material, 'color', rgba=colour)


def _numbers(*values: float) -> str:
    return ' '.join(f'{float(value)!r}' for value in values)
