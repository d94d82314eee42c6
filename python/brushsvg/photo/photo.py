"""Photographs as a camera or a scanner writes them: read upright, in light instead of a screen's numbers."""

from __future__ import annotations

import os
import re
import sys
import tempfile
import threading

import cv2
import numpy as np

from ..errors import Error
from . import PHOTOS

HEIC = (b"heic", b"heix", b"hevc", b"heim", b"heis", b"mif1", b"msf1", b"avif")  # brands of such files
BEGIN = re.compile(rb"\xff\xd8\xff|\x89PNG\r|II\*\0|MM\0\*|RIFF....WEBP", re.DOTALL)  # files of PHOTOS
# what libjpeg, libpng and libtiff say of pixels that they make up; bytes before a JPEG's end are many cameras' habit
HARM = re.compile(
    r"(?:Corrupt JPEG data: (?!\d+ extraneous bytes before marker 0xd9)|"
    r"Premature end of JPEG|libpng error: |TIFF_Error ).*"
)
LARGEST_PX = 200_000_000
STEPS_OF_50 = (
    105  # of the eight coarsest steps of a JPEG's brightness, at quality 50, summed: finer ones end at 255
)
WHITE = 0.98  # of the light: beyond, a camera's numbers end
# of the light, that the paper throws back at least: on paper of 0.03 marks were found 0.4 mm from where they were
# painted, on paper of 0.036 within 0.01 mm
DARKEST = 0.035
# of the light, standard deviation: charts with so much grain are still read, and what else goes wrong may be due to it
GRAINY = 0.05
_EVEN = (
    np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32) / 6
)  # nothing of a plane; of noise as much as it is
FLAT = 0.05  # of the light: a picture with less contrast shows nothing
# sRGB to light, of each of its 256 values: half way between paint and paper is half of the light, not of the number
_NUMBERS = np.arange(256) / 255
LIGHT = np.where(
    _NUMBERS <= 0.04045, _NUMBERS / 12.92, ((np.maximum(_NUMBERS, 0.04045) + 0.055) / 1.055) ** 2.4
).astype(np.float32)


def refuse_twice(photos: list[tuple[str, bytes]]) -> None:
    """photos: names and what their files hold. Error where one is given twice: it would count as two looks."""
    known: dict[bytes, str] = {}
    for name, data in photos:
        if data in known:
            sentence = f"this is the same photograph as {known[data]}: pass each photograph once"
            raise Error(sentence, file=name, code="photo-twice")
        known[data] = name


def read_photo(data: bytes) -> np.ndarray:
    """Pixels (rows, columns, 3) of 8 bits, blue first, turned upright as the camera was held."""
    if data[4:8] == b"ftyp" and data[8:12] in HEIC:
        raise Error(
            "this is a HEIC picture, which is not read: export it as JPEG, or let the phone take JPEGs (iPhone: "
            "Settings, Camera, Formats, Most Compatible)",
            code="photo-format",
        )
    pixels, said = _decoded(data)
    harm = HARM.search(said)
    if harm:
        raise Error(
            f"the picture is damaged or cut short, {harm[0].strip().rstrip('.')!r}: copy it from the camera once more",
            code="photo-damaged",
        )
    if pixels is None and BEGIN.match(data):
        raise Error(
            "the picture cannot be read: it is damaged, cut short, too large or of an unusual kind",
            code="photo-damaged",
        )
    if pixels is None:
        raise Error(f"this is no picture that can be read; known are {' '.join(PHOTOS)}", code="photo-format")
    if pixels.shape[0] * pixels.shape[1] > LARGEST_PX:
        raise Error(
            f"the picture has {pixels.shape[1]} x {pixels.shape[0]} pixels, more than {LARGEST_PX:.0f}: scale it down",
            code="photo-too-large",
        )
    return pixels


def refuse_dark_paper(light: float) -> None:
    """Error for paper that throws back so little light that noise is as much as paint is."""
    if light < DARKEST:
        raise Error(
            f"the paper in the picture shows {100 * light:.1f} % of the full light, at least {100 * DARKEST:g} % are "
            "needed: paint on lighter paper, or photograph it with more light",
            value=light,
            code="photo-too-dark",
        )


_one_at_a_time = threading.Lock()


def _decoded(data: bytes) -> tuple[np.ndarray | None, str]:
    """Return the pixels and the output of the libraries below OpenCV: they report damage only on the standard error of
    the process, and continue with grey."""
    with _one_at_a_time, tempfile.TemporaryFile() as heard:
        try:
            kept = os.dup(2)
        except OSError:  # there is none, as below a window
            kept = None
        if sys.stderr and kept is not None:
            sys.stderr.flush()
        os.dup2(heard.fileno(), 2)
        try:
            pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
            if pixels is not None and not data.startswith(b"\xff\xd8"):  # a JPEG is not seen through
                pixels = _on_white(pixels, cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED))
        except cv2.error:  # larger than OpenCV reads, or broken
            pixels = None
        finally:
            if kept is None:
                os.close(2)
            else:
                os.dup2(kept, 2)
                os.close(kept)
        heard.seek(0)
        return pixels, heard.read().decode("utf-8", "replace")


def _on_white(pixels: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """A picture that is seen through, as it shows on white; whole: with what its file says of that."""
    if whole is None or whole.shape != (*pixels.shape[:2], 4):
        return pixels
    full = np.iinfo(whole.dtype).max
    if whole[..., 3].min() == full:
        return pixels
    for row in range(len(pixels)):  # one by one: the picture may be large
        colour, share = whole[row, :, :3] / full, whole[row, :, 3:] / full
        pixels[row] = np.round(255 * (1 - (1 - colour) * share))
    return pixels


def jpeg_quality(data: bytes) -> float | None:
    """0 to 100 as encoders count it, from the steps that brightness is rounded to; None of other formats."""
    at = 2
    while data[:2] == b"\xff\xd8" and at + 4 <= len(data) and data[at] == 0xFF and data[at + 1] != 0xDA:
        length = int.from_bytes(data[at + 2 : at + 4], "big")
        if data[at + 1] == 0xDB and data[at + 4] == 0 and length >= 67:  # table 0, of 8 bits: brightness
            scale = 100.0 * sum(data[at + 5 : at + 13]) / STEPS_OF_50
            return (200.0 - scale) / 2 if scale < 100 else 5000.0 / scale
        at += 2 + length
    return None


def white_share(light: np.ndarray) -> float:
    """Return the share of the brightest fifth of a picture that is fully white: a camera that saw more light clips
    it."""
    levels = np.sort(light[::7, ::7].ravel())
    return float(np.mean(levels[-max(1, len(levels) // 5) :] >= WHITE))


def blur_px(light: np.ndarray) -> float:
    """Over how many pixels the steepest edges go from black to white, across or down, whichever takes longer."""
    low, high = np.quantile(light[::5, ::5], [0.01, 0.99])
    if high - low < FLAT or min(light.shape) < 2:
        return 0.0
    steepest = min(float(np.quantile(np.abs(np.diff(light, axis=axis)), 0.998)) for axis in (0, 1))
    return float(high - low) / max(steepest, 1e-3)


def refuse_grainy(light: np.ndarray, why: str) -> None:
    """Error where every pixel is so much of its own that this may be why something else is refused."""
    grain = float(np.median(np.abs(cv2.filter2D(light, -1, _EVEN)))) / 0.6745
    if grain > GRAINY:
        raise Error(
            f"{why}, and the picture is full of noise: pixels that should be alike differ by {100 * grain:.0f} % of "
            f"the light, more than {100 * GRAINY:g}: take it with more light, at a low ISO",
            value=grain,
            code="photo-noisy",
        )


def grey_light(pixels: np.ndarray) -> np.ndarray:
    """How much light a pixel shows, 0 to 1."""
    return cv2.LUT(cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY), LIGHT)
