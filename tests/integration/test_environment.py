"""A failure of the environment leaves all files or none, one sentence and an exit status."""

import os
import resource
import signal
import subprocess
import time

import pytest
from command import COMMAND, OPEN, SOUND, brushsvg, listing, refusal

MB = 1 << 20


@pytest.fixture
def desk(tmp_path):
    (tmp_path / "line.svg").write_text(SOUND)
    return tmp_path


def limited(kind: int, size: int):
    return lambda: resource.setrlimit(kind, (size, size))


# NumPy's own libraries crash on import with about 400 to 550 MB, before our code runs
@pytest.mark.parametrize(("room_mb", "is_enough"), [(150, False), (300, False), (700, True), (1000, True)])
def test_too_little_memory_is_one_error_message(desk, room_mb, is_enough):
    words = "convert", "line.svg", "-o", "out.ngc", "--picture", "out.png", "--report", "out.txt"
    done = brushsvg(
        "--messages",
        "json",
        *words,
        cwd=desk,
        env={"OPENBLAS_NUM_THREADS": "2"},  # more threads need more memory
        preexec_fn=limited(resource.RLIMIT_AS, room_mb * MB),
    )
    assert done.status == (0 if is_enough else 1), done
    assert set(listing(desk)) == {"line.svg", *(words[3::2] if is_enough else ())}
    if not is_enough:
        assert done.reported[-1][1].code == "memory-exhausted"


@pytest.mark.parametrize(
    "env",
    [
        {"HOME": None, "XDG_CONFIG_HOME": None, "XDG_CACHE_HOME": None},
        {"HOME": "/nowhere"},
        {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
        {"LC_ALL": "POSIX", "PYTHONIOENCODING": "ascii"},
        {"LC_ALL": "tr_TR.UTF-8"},
        {"LC_ALL": "ja_JP.SJIS", "PYTHONIOENCODING": "shift_jis"},
        {"LC_ALL": "no such locale"},
        {"TMPDIR": "/nowhere"},
        {"TERM": "dumb", "COLUMNS": "1"},
        {"TZ": "Nowhere/At_all"},
    ],
    ids=lambda env: " ".join(f"{key}={value}" for key, value in env.items()),
)
def test_programs_do_not_depend_on_the_environment(desk, env):
    brushsvg("convert", "line.svg", "-o", "here.ngc", cwd=desk, status=0)
    brushsvg("convert", "line.svg", "-o", "there.ngc", cwd=desk, status=0, env=env)
    assert (desk / "there.ngc").read_bytes() == (desk / "here.ngc").read_bytes()


@pytest.mark.parametrize(
    "name",
    [
        "with spaces",
        "two\nlines",
        "größe",
        "墨",
        "quote'\"s",
        "$HOME;rm -rf x",
        "a.b.c",
        b"\xff\xfe".decode(errors="surrogateescape"),
        "n" * 200,
    ],
)
def test_any_valid_file_name_is_accepted(desk, name):
    drawing, program = desk / f"{name}.svg", desk / f"{name}.ngc"
    drawing.write_text(SOUND)
    brushsvg("convert", drawing, "-o", program, cwd=desk, status=0)
    assert brushsvg("check", program, drawing, cwd=desk).status == 0
    brushsvg("convert", "line.svg", "-o", "plain.ngc", cwd=desk, status=0)
    assert (desk / "plain.ngc").read_bytes() == program.read_bytes()


@pytest.mark.parametrize("stream", [0, 1, 2])
def test_a_closed_stream_does_not_prevent_the_program(desk, stream):
    done = subprocess.run(
        [COMMAND, "convert", "line.svg", "-o", "out.ngc"],
        cwd=desk,
        preexec_fn=lambda: os.close(stream),
        check=False,
    )
    assert done.returncode == 0
    assert brushsvg("check", "out.ngc", "line.svg", cwd=desk).status == 0


READ = {
    "svg": ("convert", "{}", "-o", "out.ngc"),
    "svgz": ("convert", "{}", "-o", "out.ngc"),
    "dxf": ("convert", "{}", "-o", "out.ngc"),
    "gcode": ("convert", "{}", "-o", "out.ngc"),
    "json": ("convert", "{}", "-o", "out.ngc"),
    "brush.json": ("convert", "line.svg", "-o", "out.ngc", "--brush", "{}"),
    "toml": ("convert", "line.svg", "-o", "out.ngc", "--cell", "{}"),
    "ttf": ("text", "A", "-o", "out.svg", "--font", "{}"),
    "csv": ("calibrate", "{}", "-o", "out.json"),
    "jpg": ("compare", "{}", "line.svg"),
    "script": ("check", "{}"),
    "src": ("check", "{}"),
    "ls": ("check", "{}"),
    "ebb": ("check", "{}"),
    "plt": ("check", "{}"),
}
MOST_S, MOST_MB = 30, 1500


@pytest.mark.parametrize("suffix", READ)
@pytest.mark.parametrize("size", [0, 2 << 30], ids=["empty", "2 GB"])
def test_empty_and_huge_files_are_refused(desk, suffix, size):
    """The huge file is sparse: 2 GB of zeros that use no space on the disk."""
    file = desk / f"x.{suffix}"
    file.touch()
    os.truncate(file, size)
    words = [word.format(file.name) for word in READ[suffix]]
    done = brushsvg(
        *words, cwd=desk, status=1, timeout_s=MOST_S, preexec_fn=limited(resource.RLIMIT_DATA, MOST_MB * MB)
    )
    assert len(done.err) == 1 and file.name in done.err[0], done.err
    assert {each.name for each in desk.iterdir()} == {"line.svg", file.name}


def large(desk) -> str:
    """Return a drawing whose program needs about a second."""
    rows = "".join(
        f'<path d="M10 {y} C40 {y - 5} 60 {y + 5} 110 {y}" fill="none" stroke="#000" stroke-width="2"/>'
        for y in range(8, 54, 2)
    )
    (desk / "large.svg").write_text(f"{OPEN}{rows}</svg>")
    return "large.svg"


def test_a_killed_process_leaves_all_files_old_or_all_new(desk):
    words = [COMMAND, "convert", large(desk), "-o", "out.ngc", "--picture", "out.png", "--force"]
    subprocess.run(words, cwd=desk, check=True, capture_output=True)
    new = {name: (desk / name).read_bytes() for name in ("out.ngc", "out.png")}
    begin = time.monotonic()
    subprocess.run(words, cwd=desk, check=True, capture_output=True)
    takes_s = time.monotonic() - begin
    for k in range(24):
        for name in new:
            (desk / name).write_bytes(b"old")
        process = subprocess.Popen(words, cwd=desk, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(takes_s * (0.3 + 0.75 * k / 24))
        process.send_signal(signal.SIGKILL)
        process.wait()
        found = {name: (desk / name).read_bytes() for name in new}
        # the files are replaced one after the other; only a kill can happen between the two
        assert all(found[name] in (b"old", new[name]) for name in new), k
    brushsvg("convert", "large.svg", "-o", "out.ngc", "--force", cwd=desk, status=0)


def test_two_processes_with_one_output_leave_one_complete_file(desk):
    (desk / "other.svg").write_text(SOUND.replace("M20 40", "M25 42"))
    target = []
    for name in ("line", "other"):
        brushsvg("convert", f"{name}.svg", "-o", f"{name}.ngc", cwd=desk, status=0)
        target.append((desk / f"{name}.ngc").read_bytes())
    for _ in range(4):
        (desk / "out.ngc").unlink(missing_ok=True)
        both = [
            subprocess.Popen(
                [COMMAND, "convert", f"{name}.svg", "-o", "out.ngc", "--force"],
                cwd=desk,
                stderr=subprocess.DEVNULL,
            )
            for name in ("line", "other")
        ]
        assert [process.wait() for process in both] == [0, 0]
        assert (desk / "out.ngc").read_bytes() in target
    assert {each.suffix for each in desk.iterdir()} == {".svg", ".ngc"}, "nothing else is left"


def test_an_output_that_is_a_folder_is_refused(desk):
    (desk / "out.ngc").mkdir()
    _, notice = refusal(desk, "convert", "line.svg", "-o", "out.ngc")
    assert notice.code == "file-unwritable"
