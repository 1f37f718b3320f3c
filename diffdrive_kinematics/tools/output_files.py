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
terminal) is written to as it is, but for what grows, which has to be a file.
"""

from contextlib import suppress
import errno
import os
from pathlib import Path
import secrets
import stat
from typing import Dict, Mapping, TextIO, Tuple

__all__ = ['GrowingFile', 'check_writable', 'part_of', 'place', 'write_files']

SHOWN = 40  # characters: names of files end at 255 bytes


def check_writable(
        path: str, *, name: str = 'output', overwrite: bool, grows: bool = False) -> None:
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
    grows : bool
        Whether it is written bit by bit, for which a pipe or a device does not do.

    """
    file = Path(path)
    if file.is_dir():
        raise ValueError(f'{name} is {path!r}, which is a directory, expected a file')
    if _is_special(path):
        if grows:
            raise ValueError(
                f'{name} is {path!r}, which is a pipe or a device, expected a regular file')
        return
    if os.path.exists(path) and not overwrite:
        raise ValueError(
            f'{name} is {path!r}, which exists, expected a new file, or overwrite to be true')
    try:
        if os.path.exists(path) and not os.access(path, os.W_OK):
            raise PermissionError(f'{path} is read-only')
        os.unlink(_write_beside(path, b'', durable=False))
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
                Path(path).write_bytes(content)
            else:
                waiting[path] = _write_beside(path, content)
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
        raise FileExistsError('it has come to exist')
    with suppress(FileNotFoundError):
        old = os.stat(path)
        with suppress(PermissionError):
            os.chown(written, old.st_uid, old.st_gid)
        os.chmod(written, stat.S_IMODE(old.st_mode))
    os.replace(written, os.path.realpath(path))


def part_of(path: str) -> str:
    """Return a new name beside a file, for what is to be that file when it is complete."""
    target = Path(os.path.realpath(path))
    return str(target.with_name(f'.{target.name[:SHOWN]}.part-{secrets.token_hex(4)}'))


class GrowingFile:
    """
    A text that is written bit by bit beside its place, and put there when it is complete.

    Parameters
    ----------
    path : str
        Where it belongs.
    name : str
        Of the parameter that says so.
    overwrite : bool
        Whether a file that is there may be replaced.

    Raises
    ------
    ValueError
        If no file can be written there.

    """

    def __init__(self, path: str, *, name: str, overwrite: bool) -> None:
        check_writable(path, name=name, overwrite=overwrite, grows=True)
        self._path, self._overwrite, self._failed = path, overwrite, ''
        self._part = _write_beside(path, b'')
        self._file: TextIO = open(self._part, 'w', encoding='utf-8', newline='')

    def write(self, text: str) -> None:
        """Add to the text; that it cannot be written is said at the end."""
        try:
            if not self._failed:
                self._file.write(text)
        except OSError as error:
            self._failed = str(error)

    def close(self) -> None:
        """Put the complete text in its place; ``ValueError`` if that cannot be."""
        try:
            if self._failed:
                raise OSError(self._failed)
            self._file.flush()
            os.fsync(self._file.fileno())
            place(self._part, self._path, overwrite=self._overwrite)
        except OSError as error:
            raise ValueError(f'{self._path} cannot be written: {error}') from error
        finally:
            self.discard()

    def discard(self) -> None:
        """Leave nothing of a text that is not complete."""
        with suppress(OSError):
            self._file.close()
        with suppress(OSError):
            os.unlink(self._part)


def _is_special(path: str) -> bool:
    """Return whether there is something that is neither a file nor a directory."""
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def _write_beside(path: str, content: bytes, *, durable: bool = True) -> str:
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
