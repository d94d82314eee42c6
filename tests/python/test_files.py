"""Files are whole or not there."""

import os
import stat

import pytest
from brushsvg.errors import Error
from brushsvg.files import write_atomically


def test_text_and_bytes(tmp_path):
    write_atomically(tmp_path / "a.txt", "\u00e9\n")
    assert (tmp_path / "a.txt").read_bytes() == b"\xc3\xa9\n"
    write_atomically(str(tmp_path / "a.txt"), b"\x00\r\n")
    assert (tmp_path / "a.txt").read_bytes() == b"\x00\r\n"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_permissions_are_the_usual_ones_or_kept(tmp_path):
    (tmp_path / "usual").write_text("")
    write_atomically(tmp_path / "new", "")
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "usual").stat().st_mode
    (tmp_path / "mine").write_text("")
    (tmp_path / "mine").chmod(0o640)
    write_atomically(tmp_path / "mine", "2")
    assert stat.S_IMODE((tmp_path / "mine").stat().st_mode) == 0o640


def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "target").write_text("old")
    (tmp_path / "link").symlink_to("target")
    write_atomically(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_text() == "new"


def test_a_pipe_is_written_through(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_atomically(pipe, "through")
    assert os.read(reader, 100) == b"through"
    os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def test_places_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    for path, reason in [
        (tmp_path / "no" / "folder.txt", "no such file or directory"),
        (tmp_path, "is a directory"),
        (tmp_path / "file" / "below.txt", "not a directory"),
        (tmp_path / ("n" * 300), "file name too long"),
    ]:
        with pytest.raises(Error, match=f"cannot be written: {reason}"):
            write_atomically(path, "x")
    assert os.listdir(tmp_path) == ["file"]


def test_a_file_that_may_not_be_written_is_left_alone(tmp_path, monkeypatch):
    path = tmp_path / "locked"
    path.write_text("old")
    path.chmod(0o444)
    monkeypatch.setattr(os, "access", lambda *_: False)  # as for any user but root
    with pytest.raises(Error, match="permission denied"):
        write_atomically(path, "new")
    assert path.read_text() == "old"


def test_a_full_disk_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "kept"
    path.write_text("old")

    def full(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(Error, match="kept cannot be written: no space left"):
        write_atomically(path, "new")
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["kept"]
