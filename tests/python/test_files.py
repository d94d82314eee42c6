"""Files, and groups of files, are written completely or not at all."""

import os
import signal
import stat
import subprocess
import sys
import traceback

import pytest
from diagnostics import agrees, refused

from brushsvg.errors import Error
from brushsvg.files import read_bytes, write_files


def test_text_and_bytes_are_written(tmp_path):
    write_files({tmp_path / "a.txt": "\u00e9\n"})
    assert (tmp_path / "a.txt").read_bytes() == b"\xc3\xa9\n"
    write_files({str(tmp_path / "a.txt"): b"\x00\r\n"})
    assert (tmp_path / "a.txt").read_bytes() == b"\x00\r\n"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_permissions_are_default_or_kept(tmp_path):
    (tmp_path / "usual").write_text("")
    write_files({tmp_path / "new": ""})
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "usual").stat().st_mode
    (tmp_path / "mine").write_text("")
    (tmp_path / "mine").chmod(0o640)
    write_files({tmp_path / "mine": "2"})
    assert stat.S_IMODE((tmp_path / "mine").stat().st_mode) == 0o640


def test_writing_never_changes_the_umask(tmp_path, monkeypatch):
    """Writing never changes the umask.

    Python can read the umask only by setting it. Meanwhile, other threads created files that everybody could
    write.
    """
    monkeypatch.setattr(os, "umask", lambda mask: pytest.fail("the umask of the whole process was set"))
    (tmp_path / "mine").write_text("")
    (tmp_path / "mine").chmod(0o666)
    write_files({tmp_path / "mine": "2", tmp_path / "new": ""})
    assert stat.S_IMODE((tmp_path / "mine").stat().st_mode) == 0o666


def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "target").write_text("old")
    (tmp_path / "link").symlink_to("target")
    write_files({tmp_path / "link": "new"})
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_text() == "new"


def test_a_pipe_is_written_through(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_files({pipe: "through"})
    assert os.read(reader, 100) == b"through"
    os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def snapshot(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


PLACES = {
    "no folder": ("no/folder.txt", "no such file or directory"),
    "a folder": ("folder", "is a directory"),
    "below a file": ("kept/below.txt", "not a directory"),
    "a long name": ("n" * 300, "file name too long"),
    "a full device": ("full", "no space left on device"),
}


@pytest.mark.parametrize("case", PLACES)
@pytest.mark.parametrize("order", [1, -1])
def test_one_unwritable_path_leaves_all_files_unchanged(tmp_path, case, order):
    if case == "a full device" and not os.path.exists("/dev/full"):
        pytest.skip("needs /dev/full")
    (tmp_path / "kept").write_text("old")
    (tmp_path / "folder").mkdir()
    (tmp_path / "full").symlink_to("/dev/full")
    before = snapshot(tmp_path)
    name, reason = PLACES[case]
    files = [(tmp_path / "kept", "changed"), (tmp_path / name, "x"), (tmp_path / "new", "y")]
    with refused(f"file-unwritable '{reason}'") as refusal:
        write_files(dict(files[::order]))
    assert refusal.value.file == str(tmp_path / name)
    assert snapshot(tmp_path) == before
    assert set(os.listdir(tmp_path)) == {"kept", "folder", "full"}


def test_a_read_only_file_is_left_unchanged(tmp_path, monkeypatch):
    path = tmp_path / "locked"
    path.write_text("old")
    path.chmod(0o444)
    monkeypatch.setattr(os, "access", lambda *_: False)  # as for any user except root
    with refused("file-unwritable"):
        write_files({tmp_path / "new": "1", path: "2"})
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["locked"]


@pytest.mark.parametrize("stop", [OSError(28, os.strerror(28)), KeyboardInterrupt()])
def test_a_full_disk_or_ctrl_c_leaves_the_old_files(tmp_path, monkeypatch, stop):
    paths = [tmp_path / "first", tmp_path / "second"]
    for path in paths:
        path.write_text("old")
    flushed = []

    def flush(file):
        flushed.append(file)
        if len(flushed) == 2:
            raise stop

    monkeypatch.setattr(os, "fsync", flush)
    with pytest.raises((Error, KeyboardInterrupt)) as refusal:
        write_files(dict.fromkeys(paths, "new"))
    if isinstance(stop, OSError):
        assert agrees(refusal.value, "file-unwritable")
        assert refusal.value.file == str(paths[1])
    assert [path.read_text() for path in paths] == ["old", "old"]
    assert len(os.listdir(tmp_path)) == 2


WRITER = """
import sys
from brushsvg.files import write_files
def slowly():
    yield "half"
    print("half", flush=True)
    yield sys.stdin.read()
write_files({"word.ngc": slowly()})
"""


def writer(folder):
    """Start a process that has written half of word.ngc and waits for the other half."""
    pipe = subprocess.PIPE
    started = subprocess.Popen([sys.executable, "-c", WRITER], cwd=folder, stdin=pipe, stdout=pipe, text=True)
    assert started.stdout.readline() == "half\n"
    return started


def test_the_next_run_removes_temporary_files_of_a_killed_run(tmp_path):
    killed = writer(tmp_path)
    killed.send_signal(signal.SIGKILL)
    killed.communicate()
    (left,) = os.listdir(tmp_path)
    foreign = [
        ".word.ngc.part",
        ".word.ngc.backup-1.part",
        ".word.ngc.abcdefgh.part~",
        "word.ngc.abcdefgh.part",
    ]
    for name in foreign:
        (tmp_path / name).write_text("somebody's own")
    write_files({tmp_path / "word": "another file"})
    assert left in os.listdir(tmp_path)
    write_files({tmp_path / "word.ngc": "whole"})
    assert sorted(os.listdir(tmp_path)) == sorted(["word", "word.ngc", *foreign])


def test_the_temporary_file_of_a_running_process_is_kept(tmp_path):
    alive = writer(tmp_path)
    write_files({tmp_path / "word.ngc": "mine"})
    assert len(os.listdir(tmp_path)) == 2
    alive.communicate("and half")
    assert alive.returncode == 0
    assert os.listdir(tmp_path) == ["word.ngc"]
    assert (tmp_path / "word.ngc").read_text() == "halfand half"


@pytest.mark.parametrize("letter", ["a", "\u00fc", "\U0001f58c"])
def test_a_name_as_long_as_the_system_allows_can_be_written(tmp_path, letter):
    path = tmp_path / (letter * (255 // len(letter.encode())))
    write_files({path: "x"})
    assert os.listdir(tmp_path) == [path.name]


def test_an_unreadable_file_is_refused_in_a_sentence(tmp_path, monkeypatch):
    (tmp_path / "sound").write_bytes(b"1")
    assert read_bytes(str(tmp_path / "sound")) == b"1"
    for path, why in [
        (tmp_path / "gone", "'no such file'"),
        (tmp_path, "'is a directory'"),
        (tmp_path / "sound" / "below", "'not a directory'"),
        (tmp_path / ("n" * 300), "'name too long'"),
        ("a\0b", "'null byte'"),
    ]:
        with refused(f"file-unreadable {why}") as refusal:
            read_bytes(path)
        assert refusal.value.file == str(path)
        assert f"in {path}" in "".join(traceback.format_exception(refusal.value)), "shown in a traceback"


def test_a_number_is_not_accepted_as_a_path(tmp_path):
    with open(tmp_path / "open", "w") as file:
        for wrong in (file.fileno(), True, None, 3.5):
            with pytest.raises(TypeError):
                read_bytes(wrong)
        file.write("still open")
