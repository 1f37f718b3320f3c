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
Which codec the nodes use for which message: decided here, and nowhere else.

The plain codec makes commands, of which some tens a second are sent.  Bytes are used where a node
would spend more on message objects than on its work: in what base, noise and controller hear and
say at every tick, and in messages of many poses.  Where a message has both codecs either one does;
they have the same names, and the same tests.
"""

from diffdrive_kinematics.ros.messages.plain import TwistCodec
from diffdrive_kinematics.ros.messages.serialised import (
    encode_polygon, encode_poses, JointStateCodec, OdometryCodec, PathCodec, TransformCodec,
    TwistCodec as CommandReader)

__all__ = [
    'CommandReader', 'JointStateCodec', 'OdometryCodec', 'PathCodec', 'TransformCodec',
    'TwistCodec', 'encode_polygon', 'encode_poses']
