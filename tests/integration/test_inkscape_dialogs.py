"""Dialogs of the extension in the real Inkscape fit a small screen (virtual here)."""

import re
import subprocess
import time

import pytest
from plugin import SOURCE

DIALOGS = {  # dialogs of Extensions > Brush; the dialogs of Save As have no longer texts
    re.search(r"<id>(.*)</id>", text)[1]: re.search(r"<name>(.*)</name>", text)[1]
    for text in (path.read_text() for path in sorted(SOURCE.glob("*.inx")))
    if "<effect" in text
}
MOST_PX = 1000


@pytest.mark.parametrize(
    "dialog",
    [pytest.param(each, marks=() if each.endswith("settings") else pytest.mark.thorough) for each in DIALOGS],
)
def test_no_dialog_is_wider_than_a_small_screen(plugin, tmp_path, dialog):
    drawing = tmp_path / "drawing.svg"
    drawing.write_text('<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="60mm"/>')
    script = f"inkscape --with-gui --actions={dialog} {drawing} & while sleep 0.3; do xwininfo -root -tree; done"
    screen = ["xvfb-run", "-a", "-s", "-screen 0 2560x1600x24", "bash", "-c", script]
    shown = re.compile(rf'"{DIALOGS[dialog]}": .*?(\d+)x\d+\+')
    with subprocess.Popen(
        screen,
        env=plugin.env,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    ) as process:
        try:
            found, until = None, time.monotonic() + 60
            while found is None and time.monotonic() < until:
                found = shown.search(process.stdout.readline())
        finally:
            subprocess.run(["pkill", "-s", str(process.pid)], check=False)
    assert found is not None and int(found[1]) <= MOST_PX
