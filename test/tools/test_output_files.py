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

"""What executables write: as a whole or not at all, and never over a file that is there."""

import os
from pathlib import Path
import stat

from diffdrive_kinematics.tools import drive_table
from diffdrive_kinematics.tools.drive_table import GrowingFile
from diffdrive_kinematics.tools.output_files import check_writable, write_files
import pytest


def mode_of(path):
    return stat.S_IMODE(os.stat(path).st_mode)


def test_a_file_that_is_there_stays_as_it_is_unless_it_may_be_overwritten(tmp_path):
    file = tmp_path / 'robot.yaml'
    file.write_text('precious')
    with pytest.raises(ValueError, match="output is '.*robot.yaml', which exists.* overwrite"):
        write_files({str(file): b'new'}, overwrite=False)
    assert file.read_text() == 'precious'
    assert write_files({str(file): b'new'}, overwrite=True) == (str(file),)
    assert file.read_text() == 'new'


def test_a_link_is_followed_and_stays_a_link(tmp_path):
    (tmp_path / 'there').mkdir()
    file, link, loose = tmp_path / 'there' / 'a', tmp_path / 'link', tmp_path / 'loose'
    file.write_text('old')
    link.symlink_to(file)
    loose.symlink_to(tmp_path / 'there' / 'b')
    with pytest.raises(ValueError, match='which exists'):
        check_writable(str(link), overwrite=False)
    write_files({str(link): b'new', str(loose): b'first'}, overwrite=True)
    assert link.is_symlink() and loose.is_symlink()
    assert file.read_text() == 'new' and (tmp_path / 'there' / 'b').read_text() == 'first'


def test_a_new_file_has_the_mode_of_the_umask_and_an_old_one_keeps_its_own(tmp_path):
    before = os.umask(0o027)
    try:
        write_files({str(tmp_path / 'new'): b''}, overwrite=False)
    finally:
        os.umask(before)
    assert mode_of(tmp_path / 'new') == 0o640
    (tmp_path / 'old').touch(0o600)
    write_files({str(tmp_path / 'old'): b'1'}, overwrite=True)
    assert mode_of(tmp_path / 'old') == 0o600


@pytest.mark.parametrize('fails', ['fsync', 'replace'])
def test_a_full_disk_is_one_line_and_leaves_nothing_half(tmp_path, monkeypatch, fails):
    first, second = tmp_path / 'a.yaml', tmp_path / 'b.png'
    first.write_text('old')
    real, calls = getattr(os, fails), []

    def full(*arguments):
        calls.append(arguments)
        if len(calls) == (2 if fails == 'fsync' else 1):
            raise OSError(28, 'No space left on device')
        return real(*arguments)

    monkeypatch.setattr(os, fails, full)
    with pytest.raises(ValueError, match='cannot be written: .*No space left'):
        write_files({str(first): b'new', str(second): b'picture'}, overwrite=True)
    assert first.read_text() == 'old'
    assert [path.name for path in tmp_path.iterdir()] == ['a.yaml']


def test_an_interrupt_leaves_nothing_half(tmp_path, monkeypatch):
    def interrupted(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, 'fsync', interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_files({str(tmp_path / 'a'): b'new'}, overwrite=False)
    assert not list(tmp_path.iterdir())


def test_what_is_no_file_is_written_to_as_it_is(tmp_path):
    pipe = tmp_path / 'pipe'
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_files({str(pipe): b'picture', os.devnull: b'1'}, overwrite=False)
        assert os.read(reader, 100) == b'picture'
    finally:
        os.close(reader)
    assert stat.S_ISFIFO(os.stat(pipe).st_mode)


def test_a_pipe_that_nobody_reads_is_refused_instead_of_waited_for(tmp_path):
    pipe = tmp_path / 'pipe'
    os.mkfifo(pipe)
    with pytest.raises(ValueError, match='pipe cannot be written: .*No such device'):
        write_files({str(pipe): b'1'}, overwrite=False)


@pytest.mark.parametrize('path, words', [
    ('', 'is a directory'), ('no/a', 'a directory that can be written'),
    ('file/a', 'a directory that can be written'), ('loop', 'a directory that can be written')])
def test_what_cannot_be_written_is_refused_before_anything_is_done(tmp_path, path, words):
    (tmp_path / 'file').touch()
    (tmp_path / 'loop').symlink_to(tmp_path / 'loop')
    with pytest.raises(ValueError, match=words) as error:
        check_writable(str(tmp_path / path), name='picture', overwrite=True)
    assert str(error.value).startswith('picture is ')
    assert sorted(each.name for each in Path(tmp_path).iterdir()) == ['file', 'loop']


def test_a_growing_text_is_in_its_place_when_it_is_complete_and_not_before(tmp_path):
    file = tmp_path / 'run.csv'
    growing = GrowingFile(str(file), name='record', overwrite=False)
    growing.write('one\n')
    assert not file.exists()
    growing.write('two\n')
    growing.close()
    assert file.read_text() == 'one\ntwo\n' and [*tmp_path.iterdir()] == [file]


def test_a_growing_text_that_is_given_up_leaves_nothing(tmp_path):
    growing = GrowingFile(str(tmp_path / 'run.csv'), name='record', overwrite=False)
    growing.write('one\n')
    growing.discard()
    assert not [*tmp_path.iterdir()]


def test_a_growing_text_is_kept_beside_a_file_that_has_come_meanwhile(tmp_path):
    file, second, third = (tmp_path / name for name in ('run.csv', 'run_2.csv', 'run_3.csv'))
    growing = GrowingFile(str(file), name='record', overwrite=False)
    growing.write('one\n')
    file.write_text('mine')
    second.write_text('mine too')
    assert growing.close() == str(third)
    assert file.read_text() == 'mine' and second.read_text() == 'mine too'
    assert third.read_text() == 'one\n' and len([*tmp_path.iterdir()]) == 3


def test_a_full_disk_is_said_at_the_end_of_a_growing_text(tmp_path, monkeypatch):
    monkeypatch.setattr(  # its file is on a device that is always full
        drive_table, 'open', lambda _, *how, **more: open('/dev/full', *how, **more),
        raising=False)
    growing = GrowingFile(str(tmp_path / 'run.csv'), name='record', overwrite=False)
    for _ in range(10_000):
        growing.write('a row\n')
    with pytest.raises(ValueError, match='No space left'):
        growing.close()
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize('device', [False, True])
def test_what_grows_is_refused_where_there_is_a_pipe_or_a_device(tmp_path, device):
    path = tmp_path / 'run.csv'
    path.symlink_to('/dev/full') if device else os.mkfifo(path)
    with pytest.raises(ValueError, match='^record is .*run.csv.* pipe or a device'):
        check_writable(str(path), name='record', overwrite=True, regular=True)


def test_a_file_that_is_not_complete_has_the_name_of_what_it_is_to_be(tmp_path):
    for name in ('run.csv', 250 * 'n' + '.csv'):
        growing = GrowingFile(str(tmp_path / name), name='record', overwrite=False)
        (part,) = tmp_path.iterdir()
        assert part.name.startswith(f'.{name[:40]}') and '.part-' in part.name
        growing.close()
        (tmp_path / name).unlink()


def test_a_directory_that_does_not_exist_is_said_without_the_name_of_the_part(tmp_path):
    (tmp_path / 'file').touch()
    with pytest.raises(ValueError, match=f'directory {tmp_path / "no"} does not exist$'):
        check_writable(str(tmp_path / 'no' / 'a'), overwrite=False)
    with pytest.raises(ValueError, match='Not a directory') as error:
        check_writable(str(tmp_path / 'file' / 'a'), overwrite=False)
    assert '.part-' not in str(error.value)
