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
Parameters of a node: one table, judged as a whole, applied as a whole.

A table lists what a node knows.  The values become one frozen configuration by the node's
``build`` function, which raises ``ValueError`` for values that do not go together.  A change at
run time is judged first, without side effects, and applied only after it was accepted.
"""

from typing import (
    Any, Callable, Collection, Dict, Generic, Iterable, List, Mapping, Optional, Sequence, Tuple,
    TypeVar)

from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError
from diffdrive_kinematics.ros.parameters.other_units import report_other_units
from diffdrive_kinematics.ros.parameters.parameter_spec import descriptor_of, Kind, ParameterSpec
from diffdrive_kinematics.ros.parameters.sections import (
    doubts, misplaced, params_files, sections_of, shadowed)
from diffdrive_kinematics.ros.parameters.unknown_names import aliased, report_unknown
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

Config = TypeVar('Config')
NOT_FINITE = ('nan', '.nan', 'inf', '.inf', '-inf', '-.inf')
MISSING = ' is not set'
HOW_TO_SET = ('. Set parameters in a params file (--ros-args --params-file FILE) or one by one '
              '(--ros-args -p NAME:=VALUE)')
TYPES = {Kind.DOUBLE: Parameter.Type.DOUBLE, Kind.DOUBLES: Parameter.Type.DOUBLE_ARRAY,
         Kind.STRINGS: Parameter.Type.STRING_ARRAY}


def coerce(entry: ParameterSpec, value: Any) -> Any:
    """
    Return the value of a parameter in the type of its table entry.

    Integers are accepted for doubles, since YAML's ``1`` is an integer; so are the strings nan,
    .nan, inf and the like, which ``ros2 param load`` makes of what ``ros2 param dump`` writes.

    Raises
    ------
    ValueError
        If the type does not fit; the message names parameter, value and expectation.

    """
    if value is None and entry.kind in (Kind.STRINGS, Kind.DOUBLES):
        value = ()  # what an empty list in YAML becomes
    accepted = entry.expanded(_as_kind(entry.kind, value))
    if accepted is None:
        raise ValueError(f'{entry.name} is {value!r}, expected {entry.kind.value}')
    if entry.check is not None:
        entry.check(entry.name, accepted)
    return accepted


def _as_kind(kind: Kind, value: Any) -> Any:
    """Return the value as the kind, or None where it is of another."""
    if kind is Kind.BOOL:
        return value if isinstance(value, bool) else None
    if kind is Kind.INTEGER:
        return value if isinstance(value, int) and not isinstance(value, bool) else None
    if kind is Kind.DOUBLE:
        return _number(value) if _is_number(value) else None
    if kind is Kind.STRING:
        return value if isinstance(value, str) else None
    if isinstance(value, (str, bytes)) or not isinstance(value, Iterable):
        return None
    items = tuple(value)
    if kind is Kind.DOUBLES:
        return tuple(map(_number, items)) if all(map(_is_number, items)) else None
    return items if all(isinstance(item, str) for item in items) else None


def _is_number(value: Any) -> bool:
    if isinstance(value, str):
        return value.lower() in NOT_FINITE
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _number(value: Any) -> float:
    return float(value.replace('.', '') if isinstance(value, str) else value)


class ParameterSet(Generic[Config]):
    """
    The declared parameters of a node: ``table``, ``values`` by name, and the ``config`` of these.

    Parameters
    ----------
    node : rclpy.node.Node
        The node to declare them on.
    table : sequence of ParameterSpec
        What the node knows.
    build : callable
        Values by name -> frozen configuration; raises ``ValueError``.
    given : mapping
        What was set for the node from outside, by name.
    neighbours : collection of str, optional
        Names of all nodes of the process, where it has several.
    argv : sequence of str, optional
        Arguments that name the node's params files.

    Raises
    ------
    ConfigurationError
        If the values at start do not make a configuration.

    """

    def __init__(
            self, node: Node, table: Tuple[ParameterSpec, ...],
            build: Callable[[Mapping[str, Any]], Config], given: Mapping[str, Parameter],
            neighbours: Collection[str] = (), argv: Sequence[str] = ()) -> None:
        self._node = node
        self.table = {entry.name: entry for entry in table}
        self._build = build
        self._on_change: Optional[Callable[[Config], None]] = None
        report_unknown(node, given, self.table)
        self._report_doubts(given, neighbours, argv)
        self.values, self.config = self._judge_start(given)
        report_other_units(node, self.values, before={})
        node.add_pre_set_parameters_callback(self._in_their_types)
        node.add_on_set_parameters_callback(self._judge_change)
        node.add_post_set_parameters_callback(self._apply_change)

    def on_change(self, apply: Callable[[Config], None]) -> None:
        """Call ``apply`` with the new configuration after each accepted change."""
        self._on_change = apply

    def _judge_start(self, given: Mapping[str, Parameter]) -> Tuple[Mapping[str, Any], Config]:
        values: Dict[str, Any] = {}
        problems = []
        older = aliased(given, self.table)
        for entry in self.table.values():
            raw = self._declared(entry, given.get(older.get(entry.name, entry.name)))
            if entry.required and raw != raw:  # the default of what must be set is NaN
                wanted = entry.description.rstrip('.')
                problems.append(
                    f'{entry.name} is not set, expected {wanted[0].lower()}{wanted[1:]}')
                continue
            try:
                values[entry.name] = coerce(entry, raw)
            except ValueError as error:
                problems.append(str(error))
        if not problems:
            try:
                return values, self._build(values)
            except ValueError as error:
                problems.append(str(error))
        reason = '; '.join(problems)
        raise ConfigurationError(
            f'{self._node.get_fully_qualified_name()} refuses to start: {reason}'
            + (HOW_TO_SET if MISSING in reason else ''))

    def _declared(self, entry: ParameterSpec, given: Optional[Parameter]) -> Any:
        """Declare a parameter with what was set for it, and return that."""
        parameter = given and self._in_its_type(entry, given)
        if self._node.has_parameter(entry.name):  # rclpy declared it, and knows no table
            self._node.undeclare_parameter(entry.name)
        return self._node.declare_parameter(
            entry.name, parameter.value if parameter else entry.default, descriptor_of(entry),
            ignore_override=True).value

    def _in_their_types(self, changes: List[Parameter]) -> List[Parameter]:
        """Return changes with numbers in the types of the table; others are judged later."""
        return [self._in_its_type(self.table[change.name], change)
                if change.name in self.table else change for change in changes]

    @staticmethod
    def _in_its_type(entry: ParameterSpec, parameter: Parameter) -> Parameter:
        """Return a parameter as one of its table's type; as it is where that cannot be."""
        if entry.kind not in TYPES or (accepted := _as_kind(entry.kind, parameter.value)) is None:
            return parameter
        return Parameter(entry.name, TYPES[entry.kind], (
            accepted if entry.kind is Kind.DOUBLE else list(accepted)))

    def _judge(self, changes: Iterable[Parameter]) -> Tuple[Mapping[str, Any], Config]:
        values = dict(self.values)
        for parameter in changes:
            if parameter.name in self.table:
                values[parameter.name] = coerce(self.table[parameter.name], parameter.value)
        return values, self._build(values)

    def _judge_change(self, changes: Iterable[Parameter]) -> SetParametersResult:
        if not self._concerns(changes):
            return SetParametersResult(successful=True)
        try:
            self._judge(changes)
        except ValueError as error:
            self._node.get_logger().error(f'refused: {error}; the old value stays')
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _concerns(self, changes: Iterable[Parameter]) -> bool:
        """Return whether any parameter of the table is among the changes."""
        return any(parameter.name in self.table for parameter in changes)

    def _apply_change(self, changes: Iterable[Parameter]) -> None:
        if not self._concerns(changes):
            return
        values, config = self._judge(changes)
        if values == self.values:
            return
        report_other_units(self._node, values, self.values)
        self.values, self.config = values, config
        if self._on_change is not None:
            self._on_change(config)

    def _report_doubts(
            self, given: Mapping[str, Parameter], neighbours: Collection[str],
            argv: Sequence[str]) -> None:
        """Report sections, and names in them, that were probably meant for another node."""
        sections, node = sections_of(params_files(argv)), self._node.get_fully_qualified_name()
        for text in (*doubts(sections, node, tuple(self.table.values()), given, neighbours),
                     *misplaced(sections, node, self.table), *shadowed(sections, node, argv)):
            self._node.get_logger().warning(text)
