"""If output cannot be written completely, there is one sentence and no file changes."""

import os
import resource
import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest
from command import COMMAND, SOUND, brushsvg, listing, refusal, refused
from diagnostics import agrees


def test_output_into_a_missing_directory_is_refused(desk):
    file, reported = refusal(desk, "convert", "sound.svg", "-o", "no/where/out.ngc")
    assert file == "no/where/out.ngc" and agrees(reported, "file-unwritable")
    file, reported = refusal(desk, "convert", "sound.svg", "-o", "out.ngc", "--picture", "no/where/out.png")
    assert file == "no/where/out.png" and agrees(reported, "file-unwritable")
    (desk / "out.ngc").mkdir()
    file, reported = refusal(desk, "convert", "sound.svg", "-o", "out.ngc")
    assert file == "out.ngc" and agrees(reported, "file-unwritable")


@pytest.fixture
def as_nobody():
    """Return a folder open to all users, and settings to run a command without root."""
    folder = Path(tempfile.mkdtemp(prefix="brushsvg-"))
    folder.chmod(0o755)
    before = ()
    if os.geteuid() == 0:
        before = ("setpriv", "--reuid=65534", "--regid=65534", "--clear-groups")
        reached = subprocess.run([*before, COMMAND, "brush", "list"], capture_output=True)
        if reached.returncode != 0:
            shutil.rmtree(folder)
            pytest.skip("root may write anywhere, and nobody cannot reach the installed command")
    yield folder, {"before": before}
    for each in (folder, *folder.rglob("*")):
        each.chmod(0o755)
    shutil.rmtree(folder)


def test_missing_permissions_are_refused(as_nobody):
    folder, settings = as_nobody
    (folder / "sound.svg").write_text(SOUND)
    (folder / "secret.svg").write_text(SOUND)
    (folder / "secret.svg").chmod(0)
    (folder / "open").mkdir()
    (folder / "open" / "old.ngc").write_text("kept\n")
    (folder / "open" / "old.ngc").chmod(0o444)
    (folder / "open").chmod(0o777)
    folder.chmod(0o555)

    def reported(*words):
        ((_, notice),) = brushsvg("--messages", "json", *words, cwd=folder, status=1, **settings).reported
        return notice

    assert agrees(reported("convert", "sound.svg", "-o", "out.ngc"), "file-unwritable")
    assert agrees(reported("convert", "sound.svg", "-o", "open/old.ngc", "--force"), "file-unwritable")
    assert agrees(reported("convert", "secret.svg", "-o", "open/out.ngc"), "file-unreadable")
    assert (folder / "open" / "old.ngc").read_text() == "kept\n"
    assert sorted(os.listdir(folder / "open")) == ["old.ngc"]
    assert sorted(os.listdir(folder)) == ["open", "secret.svg", "sound.svg"]


@pytest.mark.parametrize("out", ["out.ngc", "old.ngc", "out.json", "link.ngc"])
def test_a_file_over_the_size_limit_is_removed(desk, out):
    """A limit on file size acts like a full disk or a quota."""
    (desk / "link.ngc").symlink_to("old.ngc")

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (300, 300))

    file, reported = refusal(desk, "convert", "sound.svg", "-o", out, "--force", preexec_fn=limit)
    assert file == out and agrees(reported, "file-unwritable")


def test_closed_or_full_standard_output_is_reported(desk):
    for output in ("&-", "/dev/full"):
        before = ["sh", "-c", f'exec "$@" >{output}', "sh"]
        for words in (("preview", "sound.svg"), ("brush", "list")):
            assert refused(desk, *words, before=before).startswith("standard output: ")


FULL_DISK = """
mount -t tmpfs -o size=64k none "$PWD/full" || exit 77
cp old.ngc full/old.ngc
head -c 64k /dev/zero >full/filler 2>/dev/null
"$@"
status=$?
ls -A full | sort | tr '\\n' ' '
cat full/old.ngc
exit $status
"""


@pytest.fixture
def full_disk(desk):
    """Return words before a command that make desk/full a full disk while it runs."""
    (desk / "full").mkdir()
    unshare = ["unshare", "-m"] if os.geteuid() == 0 else ["unshare", "-r", "-m"]
    before = [*unshare, "sh", "-c", FULL_DISK, "sh"]
    if subprocess.run([*before, "true"], cwd=desk, capture_output=True).returncode != 0:
        pytest.skip("a small tmpfs cannot be mounted here")
    return before


@pytest.mark.parametrize(
    "words",
    [
        ["-o", "full/out.json"],
        ["-o", "full/old.ngc"],
        ["-o", "out.ngc", "--picture", "full/out.png"],
        ["-o", "out.ngc", "--picture", "out.png", "--report", "full/out.json"],
    ],
)
def test_a_full_disk_leaves_no_files(desk, full_disk, words):
    before = listing(desk)
    words = ("--messages", "json", "convert", "sound.svg", *words, "--force")
    done = brushsvg(*words, cwd=desk, before=full_disk, status=1)
    ((_, reported),) = done.reported
    assert agrees(reported, "file-unwritable")
    assert done.out == "filler old.ngc kept\n"
    assert listing(desk) == before
