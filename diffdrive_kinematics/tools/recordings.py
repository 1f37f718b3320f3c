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

"""Recordings in CSV files, plain or gzipped, each read once, so that a pipe will do."""

from array import array
from contextlib import contextmanager
import csv
import gzip
from operator import itemgetter
from pathlib import Path
from typing import Callable, Iterator, List, Sequence, Tuple
import zlib

from diffdrive_kinematics.core.kinematics import Array
import numpy as np

COMMAND_COLUMNS = ('time_sec', 'linear_x', 'angular_z')
PROGRESS_ROWS = 4096

Header = Tuple[str, ...]
Progress = Callable[[str], None]


def nobody(_: str) -> None:
    """Be told how far it is, and do nothing."""


def read_columns(path: str, columns: Sequence[str], progress: Progress = nobody) -> Array:
    """
    Return the named columns of a CSV file with a header, shape (n, columns).

    Raises
    ------
    ValueError
        As :func:`read_chosen`.

    """
    return read_chosen(path, lambda header: check_columns(path, header, columns), progress)[1]


def check_columns(path: str, header: Header, columns: Sequence[str]) -> Sequence[str]:
    """Return columns, or raise ``ValueError`` where the header of a file lacks some."""
    missing = [name for name in columns if name not in header]
    if missing:
        raise ValueError(f'{path} has the columns {list(header)!r}, expected also {missing!r}')
    return columns


def read_chosen(
        path: str, choose: Callable[[Header], Sequence[str]], progress: Progress = nobody
) -> Tuple[Header, Array]:
    """
    Return columns of a CSV file that are chosen from its header.

    Parameters
    ----------
    path : str
        The file; one that ends with ``.gz`` is gzipped.
    choose : callable
        Returns the names of the columns to read, two or more, or raises ``ValueError``.
    progress : callable
        Is told how far it is.

    Returns
    -------
    header : tuple of str
        The names of all columns.
    rows : numpy.ndarray, shape (n, columns)
        The numbers of the columns that were chosen.

    Raises
    ------
    ValueError
        If the file cannot be read, names a column twice, has a row of more fields than columns,
        or a field that is not a number; the message names the file, the row (counted from 1,
        without the header and empty lines) and the column.

    """
    with _lines(path) as lines:
        header = tuple(name.strip() for name in next(lines, []))
        _check_header(path, header)
        columns = tuple(choose(header))
        width, pick = len(header), itemgetter(*map(header.index, columns))
        numbers, number = array('d'), 0
        for row in lines:
            if not row:
                continue
            number += 1
            if len(row) > width and any(row[width:]):
                raise ValueError(
                    f'{path}, row {number} has {len(row)} fields for the {width} columns of the '
                    'header, expected one for each, and numbers with a decimal point, as 0.50')
            try:
                numbers.extend(map(float, pick(row)))
            except (IndexError, ValueError):
                raise ValueError(_refusal(path, number, row, header, columns)) from None
            if not number % PROGRESS_ROWS:
                progress(f'{path}: {number} rows')
    return header, np.frombuffer(numbers, dtype=np.float64).reshape(-1, len(columns))


def _check_header(path: str, header: Header) -> None:
    """Raise ``ValueError`` where columns could not be told apart by their names."""
    if len(header) == 1 and any(mark in header[0] for mark in ';\t'):
        raise ValueError(
            f'{path} has the header {header[0]!r}, expected columns with commas between them, '
            'and numbers with a decimal point')
    twice = sorted({name for name in header if name and header.count(name) > 1})
    if twice:
        raise ValueError(
            f'{path} names the columns {twice!r} twice in its header, expected each name once')


def _refusal(
        path: str, number: int, row: Sequence[str], header: Header, columns: Sequence[str]
) -> str:
    """Return what is wrong with a row."""
    for name in columns:
        at = header.index(name)
        if at >= len(row):
            return (f'{path}, row {number} has {len(row)} fields and none for the column '
                    f'{name!r}, expected {len(header)}')
        try:
            float(row[at])
        except ValueError:
            return (f'{path}, row {number}: {name} is {row[at]!r}, expected a number with a '
                    'decimal point, as 0.50')
    return f'{path}, row {number}: {row!r}, expected numbers in {list(columns)!r}'


@contextmanager
def _lines(path: str) -> Iterator[Iterator[List[str]]]:
    open_text = gzip.open if Path(path).suffix == '.gz' else open
    try:
        with open_text(path, 'rt', encoding='utf-8-sig', newline='') as file:
            yield csv.reader(file, skipinitialspace=True)
    except (OSError, EOFError, UnicodeDecodeError, csv.Error, zlib.error) as error:
        raise ValueError(f'{path} cannot be read as CSV: {error}') from error
