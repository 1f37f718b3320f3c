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

"""Recordings in CSV files, plain or gzipped."""

from contextlib import contextmanager
import csv
import gzip
from pathlib import Path
from typing import Iterator, List, Sequence, Tuple
import zlib

__all__ = ['COMMAND_COLUMNS', 'read_columns', 'read_header']

COMMAND_COLUMNS = ('time_sec', 'linear_x', 'angular_z')


def read_columns(path: str, columns: Sequence[str]) -> List[Tuple[float, ...]]:
    """
    Return the named columns of a CSV file with a header, one tuple a row.

    Raises
    ------
    ValueError
        If the file cannot be read, a column is missing, or a field is not a number; the message
        names the file, and the row (counted from 1 without the header).

    """
    with _reader(path) as reader:
        missing = [name for name in columns if name not in (reader.fieldnames or ())]
        if missing:
            raise ValueError(
                f'{path} has the columns {reader.fieldnames!r}, expected also {missing!r}')
        return [_numbers(path, number, row, columns)
                for number, row in enumerate(reader, start=1)]


def read_header(path: str) -> Tuple[str, ...]:
    """Return the names of the columns of a CSV file; ``ValueError`` if it cannot be read."""
    with _reader(path) as reader:
        return tuple(reader.fieldnames or ())


@contextmanager
def _reader(path: str) -> 'Iterator[csv.DictReader[str]]':
    open_text = gzip.open if Path(path).suffix == '.gz' else open
    try:
        with open_text(path, 'rt', encoding='utf-8-sig', newline='') as file:
            yield csv.DictReader(file, skipinitialspace=True)
    except (OSError, EOFError, UnicodeDecodeError, csv.Error, zlib.error) as error:
        raise ValueError(f'{path} cannot be read as CSV: {error}') from error


def _numbers(
        path: str, number: int, row: 'dict[str, str]', columns: Sequence[str]
) -> Tuple[float, ...]:
    try:
        return tuple(float(row[name]) for name in columns)
    except (TypeError, ValueError):
        fields = [row[name] for name in columns]
        raise ValueError(
            f'{path}, row {number}: {fields!r}, expected numbers in {list(columns)!r}') from None
