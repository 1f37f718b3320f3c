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

"""Poses as three arrays, and the checks of those that a caller hands over."""

from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.kinematics import Array, Pose, Scalar
import numpy as np


class Columns(NamedTuple):
    """
    Poses as three arrays.

    Parameters
    ----------
    x, y : numpy.ndarray, shape (N,)
        Positions [m].
    theta : numpy.ndarray, shape (N,)
        Headings [rad], not wrapped.

    Examples
    --------
    >>> Columns(*np.zeros((3, 1000))).theta.shape
    (1000,)

    """

    x: Array
    y: Array
    theta: Array


def checked_columns(what: str, poses: Pose) -> Columns:
    """
    Return poses as arrays of one length.

    Parameters
    ----------
    what : str
        What the error calls them.
    poses : Pose
        The poses.

    Returns
    -------
    Columns
        The same arrays.

    Raises
    ------
    ValueError
        If one is no array of float64 of shape (N,), or N differs.

    Examples
    --------
    >>> len(checked_columns('the poses', Pose(*np.zeros((3, 5)))).x)
    5

    """
    shape = np.shape(poses.theta)
    for name, column in zip(Pose._fields, poses):
        if not (isinstance(column, np.ndarray) and column.dtype == np.float64
                and column.ndim == 1 and column.shape == shape):
            raise ValueError(
                f'{name} of {what} is {described(column)}, expected an array of float64 of '
                'shape (N,), the same for x, y and theta')
    return Columns(*poses)  # type: ignore[arg-type]


def checked_out(out: Pose, poses: Columns, travel: Tuple[Scalar, Scalar]) -> Columns:
    """
    Return arrays that may be overwritten while others are read.

    Parameters
    ----------
    out : Pose
        What is to be overwritten.
    poses : Columns
        What is read, element by element; a column of ``out`` may be the same one.
    travel : pair of float or numpy.ndarray
        What else is read.

    Returns
    -------
    Columns
        The arrays of ``out``.

    Raises
    ------
    ValueError
        If they have another length than the poses, are read-only or share memory, with each other
        or among their own elements.

    Examples
    --------
    >>> poses = Columns(*np.zeros((3, 5)))
    >>> checked_out(Pose(*poses), poses, (1.0, 1.0)) == poses
    True

    """
    columns = checked_columns('out', out)
    if len(columns.x) != len(poses.x):
        raise ValueError(f'out has {len(columns.x)} poses, expected {len(poses.x)}')
    read = [*enumerate(poses), *((None, each) for each in travel if isinstance(each, np.ndarray))]
    for place, (name, column) in enumerate(zip(Pose._fields, columns)):
        if not column.flags.writeable:
            raise ValueError(f'{name} of out is read-only, expected an array to write into')
        if len(column) > 1 and abs(column.strides[0]) < column.itemsize:
            raise ValueError(
                f'{name} of out has several poses in the same memory (stride '
                f'{column.strides[0]}), expected a place for each')
        others = [each for where, each in read if where != place or not _same(each, column)]
        if any(np.shares_memory(column, each) for each in (*others, *columns[:place])):
            raise ValueError(
                f'{name} of out shares memory with another array, expected one of its own or '
                f'{name} of the poses')
    return columns


def described(value: object) -> str:
    """
    Return a value as an error names it.

    Parameters
    ----------
    value : object
        The value.

    Returns
    -------
    str
        Of an array type and shape, else its ``repr``.

    Examples
    --------
    >>> described(np.zeros(3)), described(0.5)
    ('an array of float64 of shape (3,)', '0.5')

    """
    if isinstance(value, np.ndarray):
        return f'an array of {value.dtype} of shape {value.shape}'
    return repr(value)


def _same(one: Array, other: Array) -> bool:
    """Tell whether two arrays of one shape are the same memory in the same order."""
    addresses = {each.__array_interface__['data'][0] for each in (one, other)}
    return len(addresses) == 1 and one.strides == other.strides
