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
Files that executables write: as a whole or not at all, and never over one that is there.

Every file is written under another name beside its place, brought to the disk, and then renamed.
A link is followed, and an old file keeps its mode and owner.  What is no file (a pipe, a
terminal) is written to as it is, if somebody reads it; but what grows, and pictures, have to be
files.
"""

from contextlib import suppress
import errno
from itertools import count
import os
from pathlib import Path
import secrets
import stat
from typing import Dict, Mapping, Tuple

SHOWN = 40  # characters: names of files end at 255 bytes


def check_writable(
        path: str, *, name: str = 'output', overwrite: bool, regular: bool = False) -> None:
    """
    Raise ``ValueError`` unless a file can be written there, without writing it.

    Parameters
    ----------
    path : str
        Where it is to be written.
    name : str
        Of the parameter that says so.
    overwrite : bool
        Whether a file that is there may be replaced.
    regular : bool
        Whether a pipe or a device does not do: for what grows bit by bit, and for pictures.

    """
    file = Path(path)
    if file.is_dir():
        raise ValueError(f'{name} is {path!r}, which is a directory, expected a file')
    if _is_special(path):
        if regular:
            raise ValueError(
                f'{name} is {path!r}, which is a pipe or a device, expected a regular file')
        return
    if os.path.exists(path) and not overwrite:
        raise ValueError(
            f'{name} is {path!r}, which exists, expected a new file, or overwrite to be true')
    try:
        if os.path.exists(path) and not os.access(path, os.W_OK):
            raise PermissionError(f'{path} is read-only')
        os.unlink(write_beside(path, b'', durable=False))
    except OSError as error:
        raise ValueError(
            f'{name} is {path!r}, expected a file in a directory that can be written: {error}'
        ) from error


def write_files(files: Mapping[str, bytes], *, overwrite: bool) -> Tuple[str, ...]:
    """
    Write all files, each as a whole, and return their names.

    Parameters
    ----------
    files : mapping
        Content of each file, by its path.
    overwrite : bool
        Whether files that are there may be replaced.

    Returns
    -------
    tuple of str
        The paths.

    Raises
    ------
    ValueError
        If one exists that must not be overwritten, or cannot be written; then none is written.

    """
    for path in files:
        check_writable(path, overwrite=overwrite)
    waiting: Dict[str, str] = {}
    path = ''
    try:
        for path, content in files.items():
            if _is_special(path):
                _write_special(path, content)
            else:
                waiting[path] = write_beside(path, content)
        for path in list(waiting):
            place(waiting[path], path, overwrite=overwrite)
            del waiting[path]
    except OSError as error:
        raise ValueError(f'{path} cannot be written: {error}') from error
    finally:
        for left in waiting.values():
            with suppress(OSError):
                os.unlink(left)
    return tuple(files)


def place(written: str, path: str, *, overwrite: bool) -> None:
    """
    Rename a file that is complete to the place where it belongs.

    Parameters
    ----------
    written : str
        The complete file, on the same file system.
    path : str
        Where it belongs.
    overwrite : bool
        Whether a file that is there may be replaced.

    Raises
    ------
    OSError
        If it cannot be renamed, or a file has come there that must not be replaced.

    """
    if os.path.exists(path) and not overwrite:
        raise FileExistsError('it was made meanwhile')
    with suppress(FileNotFoundError):
        old = os.stat(path)
        with suppress(PermissionError):
            os.chown(written, old.st_uid, old.st_gid)
        os.chmod(written, stat.S_IMODE(old.st_mode))
    os.replace(written, os.path.realpath(path))


def free_path(path: str, *, overwrite: bool) -> str:
    """
    Return where to keep what took long to make: beside its place if a file has come there.

    Parameters
    ----------
    path : str
        Where it belongs.
    overwrite : bool
        Whether a file that is there may be replaced.

    Returns
    -------
    str
        ``path``, or that with ``_2``, ``_3`` ... where it is taken.

    """
    if not os.path.exists(path) or _is_special(path) or overwrite and os.path.isfile(path):
        return path
    stem, ending = os.path.splitext(os.path.realpath(path) if os.path.islink(path) else path)
    return next(other for number in count(2)
                if not os.path.lexists(other := f'{stem}_{number}{ending}'))


def beside(path: str, kept: str) -> str:
    """Return the words for where something is kept that belongs in ``path``."""
    return path if kept == path else f'{kept}, as {path} was made meanwhile'


def part_of(path: str) -> str:
    """Return a new name beside a file, for what is to be that file when it is complete."""
    target = Path(os.path.realpath(path))
    return str(target.with_name(f'.{target.name[:SHOWN]}.part-{secrets.token_hex(4)}'))


def _is_special(path: str) -> bool:
    """Return whether there is something that is neither a file nor a directory."""
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def _write_special(path: str, content: bytes) -> None:
    """Write to what is no file; ``OSError`` if it is a pipe that nobody reads, without waiting."""
    handle = os.open(path, os.O_WRONLY | os.O_NONBLOCK)
    os.set_blocking(handle, True)
    with os.fdopen(handle, 'wb') as file:
        file.write(content)


def write_beside(path: str, content: bytes, *, durable: bool = True) -> str:
    """Write a file under another name beside its place, bring it to the disk; return its name."""
    target = Path(os.path.realpath(path))
    if target.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
    if not target.parent.exists():
        raise FileNotFoundError(f'directory {target.parent} does not exist')
    name = part_of(path)
    try:
        handle = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(target)) from error
    try:
        with os.fdopen(handle, 'wb') as file:
            file.write(content)
            file.flush()
            if durable:
                os.fsync(file.fileno())
    except BaseException:
        os.unlink(name)
        raise
    return name
