"""Notices in Inkscape use the words of its dialogs, and batch runs open no dialog."""

import re

import pytest
from command import OPEN, SOUND, path
from plugin import SOURCE

IMAGE = '<image id="photo" href="x.png" width="10" height="10"/>'
FILLED = f'{OPEN}<path id="i" d="M20 10h3v30h-3z"/>{IMAGE}</svg>'
TOO_WIDE = path("M20 30 H90", width="30")


@pytest.mark.parametrize(
    ("drawing", "action", "suffix", "reported"),
    [
        (
            FILLED,
            "org.brushsvg.strokes.noprefs",
            "svg",
            b"Converted. brushsvg warns:\nphoto: image is not read",
        ),
        (FILLED, "select-clear", "ngc", b"Saved. brushsvg warns:\nphoto: image is not read"),
        (
            TOO_WIDE,
            "org.brushsvg.preview.noprefs",
            "svg",
            b"brushsvg refuses:\np: width 30.000 mm is outside",
        ),
        (TOO_WIDE, "select-clear", "ngc", b"brushsvg refuses:\np: width 30.000 mm is outside"),
    ],
)
def test_batch_runs_end_and_write_messages_to_stderr(plugin, tmp_path, drawing, action, suffix, reported):
    """An open dialog would block the run until its time limit."""
    source = tmp_path / "drawing.svg"
    source.write_text(drawing)
    assert reported in plugin.batch(source, tmp_path / f"out.{suffix}", action).stderr


def test_warnings_are_on_stderr_without_a_display(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(SOUND.replace("</svg>", f"{IMAGE}</svg>"))
    done = plugin.save(source, tmp_path / "out.ngc")
    assert b"Saved. brushsvg warns:\nphoto: image is not read" in done.stderr
    assert (tmp_path / "out.ngc").read_bytes().endswith(b"M2\n")


def document(setting: str) -> str:
    return SOUND.replace("<svg ", f"<svg {setting} ")


ADVICE = {  # by the code of the notice: the script and the drawing that cause it
    "background": (
        "save",
        SOUND.replace("<path", '<rect x="-1" y="-1" width="900" height="900" fill="#fff"/><path', 1),
    ),
    "brush-unknown": ("preview", document('data-brushsvg-brush="mine"')),
    "cell-unknown": ("preview", document('data-brushsvg-cell="mine"')),
    "depth-not-measured": ("preview", path("M20 30 H90", width="0.1")),
    "width-out-of-reach": (
        "check",
        f'{OPEN}<path id="bar" d="M20 20h60v14h-60z"/></svg>'.replace("<svg ", '<svg data-brushsvg-wide="clamp" '),
    ),
    "lines-meet": (
        "check",
        f'{OPEN}<g fill="none" stroke="#000" stroke-width="3"><path d="M20 20H60"/><path d="M60 20V40"/>'
        '<path d="M60 40H20"/></g></svg>',
    ),
    "paper-example": ("save", document('data-brushsvg-cell="ur5e"'), "--format=script"),
    "sheet-too-small": ("chart", SOUND, "--strokes=many", "--sheet=letter"),
    "program-format": ("save", document('data-brushsvg-cell="linuxcnc-3axis"'), "--format=script"),
    "text-unread": ("save", SOUND.replace("</svg>", '<text id="word" x="9" y="9">a</text></svg>')),
}


@pytest.fixture
def in_dialogs(monkeypatch):
    monkeypatch.syspath_prepend(SOURCE)
    from brushsvg_dialogs import IN_DIALOGS

    return IN_DIALOGS


@pytest.mark.parametrize("code", ADVICE)
def test_advice_is_worded_for_users_of_dialogs(plugin, tmp_path, in_dialogs, code):
    script, text, *words = ADVICE[code]
    source = tmp_path / "drawing.svg"
    source.write_text(text)
    done = plugin.script(script, source, *words)
    reported = " ".join(
        re.sub("<[^>]*>", " ", (done.stdout + done.stderr).decode()).split()
    )  # the check wraps its lines
    assert in_dialogs[code] in reported.replace("&gt;", ">")
    assert "--" not in reported.replace("brushsvg cell new --taught, in a terminal", ""), "a flag"


@pytest.mark.parametrize(
    ("sentence", "advice", "shown"),
    [
        ("too wide; --wide passes helps", "--wide passes helps", "too wide"),
        ("height 0; --brush rigid helps", "", "height 0"),
        ("no unit: give --units mm", "", "no unit"),
        ("no map: brushsvg height --x", "", "no map"),
        ("cut short", "", "cut short"),
    ],
)
def test_no_flag_is_shown_in_a_dialog(monkeypatch, sentence, advice, shown):
    monkeypatch.syspath_prepend(SOURCE)
    from brushsvg_dialogs import in_dialogs

    notice = {"sentence": sentence, "advice": advice, "code": "any", "damaged": False, "refused": False}
    assert in_dialogs(notice) == shown


def test_damaged_paths_get_advice_to_repair_them(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(path("M20 30 H90 V"))
    assert b"; repair or delete it, or draw it again" in plugin.script("save", source).stderr


def test_a_suggested_cell_is_named(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(document('data-brushsvg-cell="linuxcnc-3axis"'))
    done = plugin.script("save", source, "--format=script")
    named = re.search(r"; \.script is for cell (.+); choose it in Brush settings\n$", done.stderr.decode())
    assert named, done.stderr
    assert "ur5e" in named[1].split(" or ")


def test_all_advice_is_tested(in_dialogs):
    assert set(ADVICE) == set(in_dialogs)


def test_temporary_files_are_not_named_in_messages(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(document('data-brushsvg-brush="rigid"'))
    assert plugin.script("chart", source).stderr.startswith(b"brushsvg refuses:\nbrush: brush rigid is a pen")
    (tmp_path / "mine.json").write_text("{}")
    done = plugin.script("preview", source, f"--brush_file={tmp_path / 'mine.json'}")
    assert f"{tmp_path / 'mine.json'}: ".encode() in done.stderr
