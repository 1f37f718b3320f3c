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

"""The wheel joints of a robot as messages know them: names, sides, directions, and the gear."""

from typing import Any, Mapping, NamedTuple, Tuple

from diffdrive_kinematics.core.odometry import WheelPair

Names = Tuple[str, ...]


class WheelJoints(NamedTuple):
    """
    Joints of the (left, right) wheels, whether they are inverted, and turns of them a wheel turn.

    An inverted joint turns backward where the wheel rolls forward, as a motor that is mounted as
    the mirror image of the other does.  Messages have the motion of the joints; everything else
    has that of the wheels: readings are divided by the gear ratio, what is written is multiplied.
    """

    names: Tuple[Names, Names]
    inverted: Tuple[bool, bool] = (False, False)
    gear_ratio: float = 1.0

    def all_names(self) -> Names:
        """Return the names of all joints, those of the left side first."""
        return self.names[0] + self.names[1]

    def signed(self, pair: WheelPair) -> WheelPair:
        """Return a pair with the signs of joints for wheels, or back; zero has no sign."""
        left, right = pair
        left_inverted, right_inverted = self.inverted
        return 0.0 - left if left_inverted else left, 0.0 - right if right_inverted else right

    def motion(self, pair: WheelPair) -> WheelPair:
        """Return the motion of joints, of an angle or a rate of the wheels."""
        left, right = self.signed(pair)
        return self.gear_ratio * left, self.gear_ratio * right

    def spread(self, pair: WheelPair) -> 'list[float]':
        """Return a value of each side as one of each joint."""
        left, right = pair
        return [left] * len(self.names[0]) + [right] * len(self.names[1])


def wheel_joints(values: Mapping[str, Any]) -> WheelJoints:
    """Return the joints of a node's parameter values."""
    return WheelJoints(
        (tuple(values['left_wheel_names']), tuple(values['right_wheel_names'])),
        (values['left_wheel_inverted'], values['right_wheel_inverted']), values['gear_ratio'])
