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
The message type of ``/tf`` where no package tf2_msgs is installed, as with ROS 2 from wheels.

It is made at run time, without a compiler: a type support as rosidl generates it in C, out of
those of ``nav_msgs/Path`` (a message that ends in a sequence) and of
``geometry_msgs/TransformStamped`` (of which the sequence is).  It carries serialised messages
only, and only by rmw_fastrtps_cpp, the middleware of the wheels.
"""

import ctypes
from functools import lru_cache
from typing import Any, cast, List, Optional

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Path
from rclpy.utilities import get_rmw_implementation_identifier

NAME, HASH_VERSION = b'TFMessage', b'\x01'
HASH = bytes.fromhex('e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087')
MADE_FOR = 'rmw_fastrtps_cpp'
FAST_CDR, FIELDS = b'rosidl_typesupport_fastrtps_c', b'rosidl_typesupport_introspection_c'
NESTED, NESTED_SEQUENCE = 18, 145  # of rosidl_typesupport_introspection_c, and in a description
PATH = (b'Path', 2, 56, [(b'header', NESTED, False, 0), (b'poses', NESTED, True, 32)])
POINTER, SIZE = ctypes.c_void_p, ctypes.c_size_t


class _Support(ctypes.Structure):
    """``rosidl_message_type_support_t``."""

    _fields_ = [('identifier', ctypes.c_char_p), ('data', POINTER), ('find', POINTER),
                ('hash', POINTER), ('description', POINTER), ('sources', POINTER)]


class _Callbacks(ctypes.Structure):
    """``message_type_support_callbacks_t`` of rosidl_typesupport_fastrtps_c."""

    _fields_ = [('namespace', ctypes.c_char_p), ('name', ctypes.c_char_p),
                ('functions', POINTER * 5)]


class _Member(ctypes.Structure):
    """``rosidl_typesupport_introspection_c__MessageMember``."""

    _fields_ = [('name', ctypes.c_char_p), ('type_id', ctypes.c_uint8), ('bound', SIZE),
                ('support', POINTER), ('is_key', ctypes.c_bool), ('is_array', ctypes.c_bool),
                ('array_size', SIZE), ('is_bounded', ctypes.c_bool), ('offset', ctypes.c_uint32),
                ('default', POINTER), ('functions', POINTER * 6)]


class _Members(ctypes.Structure):
    """``rosidl_typesupport_introspection_c__MessageMembers``."""

    _fields_ = [('namespace', ctypes.c_char_p), ('name', ctypes.c_char_p),
                ('count', ctypes.c_uint32), ('size', SIZE), ('has_key', ctypes.c_bool),
                ('members', ctypes.POINTER(_Member)), ('functions', POINTER * 2)]


class _String(ctypes.Structure):
    """``rosidl_runtime_c__type_description__String``."""

    _fields_ = [('data', ctypes.c_char_p), ('size', SIZE), ('capacity', SIZE)]

    @classmethod
    def of(cls, text: bytes) -> '_String':
        return cls(text, len(text), len(text) + 1)


class _Field(ctypes.Structure):
    """``rosidl_runtime_c__type_description__Field``."""

    _fields_ = [('name', _String), ('type_id', ctypes.c_uint8), ('capacity', ctypes.c_uint64),
                ('string_capacity', ctypes.c_uint64), ('nested', _String), ('default', _String)]


class _Type(ctypes.Structure):
    """``rosidl_runtime_c__type_description__IndividualTypeDescription``."""

    _fields_ = [('name', _String), ('fields', ctypes.POINTER(_Field)), ('size', SIZE),
                ('capacity', SIZE)]


class _Description(ctypes.Structure):
    """``rosidl_runtime_c__type_description__TypeDescription``."""

    _fields_ = [('type', _Type), ('others', ctypes.POINTER(_Type)), ('size', SIZE),
                ('capacity', SIZE)]


FIND = ctypes.CFUNCTYPE(POINTER, POINTER, ctypes.c_char_p)
TELL = ctypes.CFUNCTYPE(POINTER, POINTER)
NAME_OF = ctypes.PYFUNCTYPE(ctypes.c_char_p, ctypes.py_object)(
    ('PyCapsule_GetName', ctypes.pythonapi))
CONTENT_OF = ctypes.PYFUNCTYPE(POINTER, ctypes.py_object, ctypes.c_char_p)(
    ('PyCapsule_GetPointer', ctypes.pythonapi))
CAPSULE = ctypes.PYFUNCTYPE(ctypes.py_object, POINTER, ctypes.c_char_p, POINTER)(
    ('PyCapsule_New', ctypes.pythonapi))


def _support_of(message_type: Any, identifier: bytes) -> Optional[_Support]:
    """Return a type support of an installed message; None where it has none of this kind."""
    if message_type.__class__._TYPE_SUPPORT is None:
        message_type.__class__.__import_type_support__()
    capsule = message_type.__class__._TYPE_SUPPORT
    address = CONTENT_OF(capsule, NAME_OF(capsule))
    found = FIND(_Support.from_address(address).find)(address, identifier)
    return _Support.from_address(found) if found else None


def _description(support: _Support, kept: list) -> _Description:
    """Return what the type is made of: its field, and the types in that."""
    part = _Description.from_address(TELL(support.description)(ctypes.addressof(support)))
    types = sorted([part.type, *part.others[:part.size]], key=lambda each: each.name.data)
    field = _Field(_String.of(b'transforms'), NESTED_SEQUENCE, 0, 0, part.type.name,
                   _String.of(b''))
    others, fields = (_Type * len(types))(*types), (_Field * 1)(field)
    kept += [others, fields]
    return _Description(
        _Type(_String.of(b'tf2_msgs/msg/TFMessage'), fields, 1, 1), others, len(types), len(types))


@lru_cache(maxsize=None)
def tf_message_type() -> Optional[type]:
    """
    Return a message type for ``/tf`` whose messages are bytes; None where none can be made.

    Returns
    -------
    type or None
        For ``create_publisher`` and for subscriptions with ``raw=True``.  None: the middleware is
        another one, or the type supports of this ROS 2 are built otherwise.

    """
    if get_rmw_implementation_identifier() != MADE_FOR:
        return None
    found = [_support_of(each, identifier) for each in (Path, TransformStamped)
             for identifier in (FAST_CDR, FIELDS)]
    if None in found:
        return None
    path, path_fields, transform, transform_fields = cast(List[_Support], found)
    members = _Members.from_address(path_fields.data)
    if PATH != (members.name, members.count, members.size, [
            (each.name, each.type_id, each.is_array, each.offset)
            for each in members.members[:2]]):
        return None
    kept: list = []  # what C has only pointers of
    transforms = _Member.from_buffer_copy(members.members[1])
    transforms.name, transforms.offset = b'transforms', 0
    transforms.support = ctypes.addressof(transform_fields)
    own_members = _Members(
        b'tf2_msgs__msg', NAME, 1, members.size - members.members[1].offset, False,
        (_Member * 1)(transforms), members.functions)
    callbacks = _Callbacks(b'tf2_msgs::msg', NAME, _Callbacks.from_address(path.data).functions)
    hashed = ctypes.create_string_buffer(HASH_VERSION + HASH, 1 + len(HASH))
    description = _description(transform, kept)
    tell_hash = TELL(lambda _: ctypes.addressof(hashed))
    tell_description = TELL(lambda _: ctypes.addressof(description))
    told = (ctypes.cast(tell_hash, POINTER), ctypes.cast(tell_description, POINTER),
            transform.sources)
    supports = {
        FAST_CDR: _Support(FAST_CDR, ctypes.addressof(callbacks), path.find, *told),
        FIELDS: _Support(FIELDS, ctypes.addressof(own_members), path_fields.find, *told)}

    def find(_: int, identifier: bytes) -> Optional[int]:
        support = supports.get(identifier)
        return None if support is None else ctypes.addressof(support)

    finder = FIND(find)
    whole = _Support(b'rosidl_typesupport_c', None, ctypes.cast(finder, POINTER), *told)
    kept += [own_members, callbacks, hashed, description, tell_hash, tell_description, supports,
             finder, whole]

    def converted(*_: Any) -> None:
        raise TypeError('without tf2_msgs messages of /tf are bytes')

    functions = dict.fromkeys(
        ('_CREATE_ROS_MESSAGE', '_CONVERT_FROM_PY', '_CONVERT_TO_PY', '_DESTROY_ROS_MESSAGE'),
        staticmethod(converted))
    meta = type('Metaclass_TFMessage', (type,), {
        **functions, '_TYPE_SUPPORT': CAPSULE(ctypes.addressof(whole), None, None),
        '_kept': kept})
    return meta('TFMessage', (), {'__module__': 'tf2_msgs.msg'})
