"""What Inkscape's user is told: in the words of dialogs, and without a dialog that nobody can close."""

import pytest
from command import OPEN, SOUND, path
from plugin import Plugin

IMAGE = '<image id="photo" href="x.png" width="10" height="10"/>'
FILLED = f'{OPEN}<path id="i" d="M20 10h3v30h-3z"/>{IMAGE}</svg>'
TOO_WIDE = path("M20 30 H90", width="30")


@pytest.fixture(scope="module")
def plugin(tmp_path_factory):
    return Plugin(tmp_path_factory.mktemp("plugin"))


@pytest.mark.parametrize(
    ("drawing", "action", "suffix", "told"),
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
def test_in_batches_inkscape_ends_and_what_it_would_show_is_on_stderr(
    plugin, tmp_path, drawing, action, suffix, told
):
    """A dialog would stay until the time is up."""
    source = tmp_path / "drawing.svg"
    source.write_text(drawing)
    assert told in plugin.batch(source, tmp_path / f"out.{suffix}", action).stderr


def test_without_a_display_warnings_are_on_stderr_too(plugin, tmp_path):
    source = tmp_path / "drawing.svg"
    source.write_text(SOUND.replace("</svg>", f"{IMAGE}</svg>"))
    done = plugin.save(source, tmp_path / "out.ngc")
    assert b"Saved. brushsvg warns:\nphoto: image is not read" in done.stderr
    assert (tmp_path / "out.ngc").read_bytes().endswith(b"M2\n")
