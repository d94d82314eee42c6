"""Ctrl-C stops at once with status 130 and no files; only a terminal shows progress."""

import os
import pty
import select
import signal
import subprocess
import sys
import time

import pytest
from command import COMMAND, OPEN, brushsvg, listing
from diagnostics import gives


@pytest.fixture(scope="session")
def long_drawing():
    """Return 700 strokes, which need some seconds of work."""
    wave = "c10 -20 25 -20 30 0s10 10 15 -5"
    paths = "".join(
        f'<path d="M{10 + 58 * column} {20 + 20 * row}{wave}" fill="none" stroke="#000" stroke-width="3"/>'
        for row in range(35)
        for column in range(20)
    )
    return f"{OPEN.replace('120', '1200').replace('60', '1600')}{paths}</svg>"


def started_at_terminal(folder, *words):
    """Return a process whose stderr is a terminal, and the other end of the terminal."""
    terminal, its_end = pty.openpty()
    process = subprocess.Popen(
        [COMMAND, *words],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=its_end,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    os.close(its_end)
    return process, terminal


def read_until(terminal, word, timeout_s=60):
    text, end = b"", time.monotonic() + timeout_s
    while word not in text and time.monotonic() < end:
        if select.select([terminal], [], [], 0.2)[0]:
            try:
                part = os.read(terminal, 65536)
            except OSError:
                break
            if not part:
                break
            text += part
    return text


@pytest.mark.parametrize("stage", [b"reading", b"compensated", b"simulated", b"outlined"])
def test_ctrl_c_stops_at_once_and_leaves_no_files(desk, long_drawing, stage):
    (desk / "long.svg").write_text(long_drawing)
    before = listing(desk)
    words = [
        "convert",
        "long.svg",
        "-o",
        "old.ngc",
        "--force",
        "--picture",
        "out.svg",
        "--report",
        "out.json",
    ]
    process, terminal = started_at_terminal(desk, *words)
    try:
        seen = read_until(terminal, stage)
        assert stage in seen, seen[-300:]
        process.send_signal(signal.SIGINT)
        requested = time.monotonic()
        rest = read_until(terminal, b"\0 never", timeout_s=10)
        assert process.wait(timeout=10) == 130, rest
        assert time.monotonic() - requested < 2
        assert rest.decode().splitlines()[-1].endswith("brushsvg: interrupted")
        assert b"Traceback" not in rest
    finally:
        process.kill()
        process.wait()
        os.close(terminal)
    assert listing(desk) == before


def test_progress_is_shown_only_in_a_terminal(desk):
    process, terminal = started_at_terminal(desk, "convert", "sound.svg", "-o", "out.ngc")
    assert b"compensated" in read_until(terminal, b"\0 never")
    assert process.wait(timeout=30) == 0
    os.close(terminal)
    (line,) = brushsvg("convert", "sound.svg", "-o", "out.ngc", cwd=desk, status=0).err
    assert gives(line, "out.ngc", "1")


@pytest.mark.parametrize("module", ["argparse", "brushsvg.cli.commands", "numpy", "brushsvg._core"])
def test_ctrl_c_during_start_up_stops_without_traceback(desk, module):
    """The signal arrives while modules are loaded, before any progress is shown."""
    code = (
        "import os, signal, sys\n"
        "from brushsvg.cli import main\n"
        "def hook(event, values):\n"
        f"    if event == 'import' and values[0] == {module!r}:\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.addaudithook(hook)\n"
        "sys.exit(main())\n"
    )
    before = listing(desk)
    done = subprocess.run(
        [sys.executable, "-c", code, "convert", "sound.svg", "-o", "out.ngc"],
        cwd=desk,
        capture_output=True,
        text=True,
        timeout=60,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "brushsvg: interrupted\n")
    assert listing(desk) == before
