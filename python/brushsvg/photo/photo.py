"""Read the photographs of cameras and scanners: upright, and as linear light instead of sRGB values."""

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

# Brands of HEIC and AVIF files.
HEIF_BRANDS = (b"heic", b"heix", b"hevc", b"heim", b"heis", b"mif1", b"msf1", b"avif")
# First bytes of the formats in PHOTOS. OpenCV decodes more formats, some from a few bytes into a huge picture.
IMAGE_SIGNATURES = re.compile(rb"\xff\xd8\xff|\x89PNG\r|II[*+]\0|MM\0[*+]|RIFF....WEBP", re.DOTALL)
# Messages of libjpeg, libpng and libtiff about pixels that they had to invent. Extra bytes before the end of a JPEG are
# no damage, because many cameras write them.
DAMAGE_MESSAGES = re.compile(
    r"(?:Corrupt JPEG data: (?!\d+ extraneous bytes before marker 0xd9)|"
    r"Premature end of JPEG|libpng error: |TIFF_Error ).*"
)
MAX_PIXELS = 200_000_000
# Sum of the first eight quantisation steps of a JPEG's brightness at quality 50, which are for its coarsest details.
# They are used because the steps for finer details are capped at 255.
QUALITY_50_STEP_SUM = 105
MIN_WHITE_LIGHT = 0.98  # share of the light above which a camera's values are clipped
# Smallest share of the light that the paper must reflect. On paper of 0.03, marks were found 0.4 mm from where they
# were painted; on paper of 0.036, within 0.01 mm.
MIN_PAPER_LIGHT = 0.035
# Standard deviation, as a share of the light. Charts with this much grain can still be read, but grain may be the
# reason for other refusals.
MAX_GRAIN = 0.05
# Responds with 0 to a plane, and to noise with the same standard deviation.
_GRAIN_FILTER = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32) / 6
MIN_CONTRAST = 0.05  # share of the light: a picture with less contrast shows nothing
# Linear light of each of the 256 sRGB values. Half way between paint and paper is half of the light, not half of the
# sRGB value.
_SRGB_VALUES = np.arange(256) / 255
LIGHT = np.where(
    _SRGB_VALUES <= 0.04045,
    _SRGB_VALUES / 12.92,
    ((np.maximum(_SRGB_VALUES, 0.04045) + 0.055) / 1.055) ** 2.4,
).astype(np.float32)


def refuse_twice(photos: list[tuple[str, bytes]]) -> None:
    """Raise Error where a photograph is given twice.

    The same photograph would count as two measurements. photos: name and content of each file.
    """
    name_of_content: dict[bytes, str] = {}
    for name, data in photos:
        if data in name_of_content:
            sentence = f"this is the same photograph as {name_of_content[data]}: pass each photograph once"
            raise Error(sentence, file=name, code="photo-twice")
        name_of_content[data] = name


def read_photo(data: bytes) -> np.ndarray:
    """Return the 8-bit pixels (rows, columns, 3) of a photograph, blue first.

    The picture is rotated as the camera was held. Raises Error for files that are damaged, too large or not in one of
    the known formats.
    """
    if data[4:8] == b"ftyp" and data[8:12] in HEIF_BRANDS:
        raise Error(
            "HEIC pictures cannot be read: export the picture as JPEG, or set the phone to take JPEGs (iPhone: "
            "Settings, Camera, Formats, Most Compatible)",
            code="photo-format",
        )
    if not IMAGE_SIGNATURES.match(data):
        raise Error(f"this file is not a picture that can be read; known: {' '.join(PHOTOS)}", code="photo-format")
    pixels, messages = _decode(data)
    damage = DAMAGE_MESSAGES.search(messages)
    if damage:
        raise Error(
            f"the picture is damaged or incomplete ({damage[0].strip().rstrip('.')!r}): copy it from the camera again",
            code="photo-damaged",
        )
    if pixels is None:
        sentence = "the picture cannot be read: it is damaged, incomplete, too large or of an unusual kind"
        raise Error(sentence, code="photo-damaged")
    if pixels.shape[0] * pixels.shape[1] > MAX_PIXELS:
        raise Error(
            f"the picture has {pixels.shape[1]} x {pixels.shape[0]} pixels, more than {MAX_PIXELS:.0f}: scale it down",
            code="photo-too-large",
        )
    return pixels


def refuse_dark_paper(light: float) -> None:
    """Raise Error for paper that is too dark. Such paper reflects so little light that noise is as strong as paint."""
    if light < MIN_PAPER_LIGHT:
        raise Error(
            f"the paper in the picture shows {100 * light:.1f} % of the full light, at least "
            f"{100 * MIN_PAPER_LIGHT:g} % are needed: paint on lighter paper, or photograph it with more light",
            value=light,
            code="photo-too-dark",
        )


_stderr_lock = threading.Lock()


def _decode(data: bytes) -> tuple[np.ndarray | None, str]:
    """Decode a picture and return its pixels and the libraries' messages.

    The pixels are None where the picture cannot be decoded. The libraries below OpenCV report damage only on the
    standard error of the process, and fill the missing pixels with grey.
    """
    with _stderr_lock, tempfile.TemporaryFile() as captured:
        try:
            saved_stderr = os.dup(2)
        except OSError:  # a program with a window has no standard error
            saved_stderr = None
        if sys.stderr and saved_stderr is not None:
            sys.stderr.flush()
        os.dup2(captured.fileno(), 2)
        try:
            pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
            if pixels is not None and not data.startswith(b"\xff\xd8"):  # a JPEG has no transparency
                pixels = _composite_on_white(pixels, cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED))
        except cv2.error:  # too large for OpenCV, or damaged
            pixels = None
        finally:
            if saved_stderr is None:
                os.close(2)
            else:
                os.dup2(saved_stderr, 2)
                os.close(saved_stderr)
        captured.seek(0)
        return pixels, captured.read().decode("utf-8", "replace")


def _composite_on_white(pixels: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """Place a transparent picture on white; whole: pixels with opacity (rows, columns, 4), or None."""
    if whole is None or whole.shape != (*pixels.shape[:2], 4):
        return pixels
    full = np.iinfo(whole.dtype).max
    if whole[..., 3].min() == full:
        return pixels
    for row in range(len(pixels)):  # row by row, because the picture may be large
        colour, opacity = whole[row, :, :3] / full, whole[row, :, 3:] / full
        pixels[row] = np.round(255 * (1 - (1 - colour) * opacity))
    return pixels


def jpeg_quality(data: bytes) -> float | None:
    """Return the quality of a JPEG, 0 to 100, or None for other formats.

    The quality, on the scale of encoders, follows from the quantisation steps of the brightness.
    """
    at = 2
    while data[:2] == b"\xff\xd8" and at + 4 <= len(data) and data[at] == 0xFF and data[at + 1] != 0xDA:
        length = int.from_bytes(data[at + 2 : at + 4], "big")
        if data[at + 1] == 0xDB and data[at + 4] == 0 and length >= 67:  # 8-bit table 0 holds the brightness
            scale = 100.0 * sum(data[at + 5 : at + 13]) / QUALITY_50_STEP_SUM
            return (200.0 - scale) / 2 if scale < 100 else 5000.0 / scale
        at += 2 + length
    return None


def white_share(light: np.ndarray) -> float:
    """Return the share of a picture's brightest fifth that is fully white. The share is large in a clipped picture."""
    levels = np.sort(light[::7, ::7].ravel())
    return float(np.mean(levels[-max(1, len(levels) // 5) :] >= MIN_WHITE_LIGHT))


def blur_px(light: np.ndarray) -> float:
    """Return the width [px] of the steepest edges from black to white.

    The larger of the widths across and down counts.
    """
    low, high = np.quantile(light[::5, ::5], [0.01, 0.99])
    if high - low < MIN_CONTRAST or min(light.shape) < 2:
        return 0.0
    steepest = min(float(np.quantile(np.abs(np.diff(light, axis=axis)), 0.998)) for axis in (0, 1))
    return float(high - low) / max(steepest, 1e-3)


def refuse_grainy(light: np.ndarray, why: str) -> None:
    """Raise Error where grain may be the reason for another refusal. why: the other refusal, for the message."""
    grain = float(np.median(np.abs(cv2.filter2D(light, -1, _GRAIN_FILTER)))) / 0.6745
    if grain > MAX_GRAIN:
        raise Error(
            f"{why}, because the picture is too noisy: pixels that should be equal differ by {100 * grain:.0f} % of "
            f"the light, more than {100 * MAX_GRAIN:g} %. Take it with more light and a low ISO",
            value=grain,
            code="photo-noisy",
        )


def grey_light(pixels: np.ndarray) -> np.ndarray:
    """Return the light (rows, columns) of each pixel, from 0 to 1."""
    return cv2.LUT(cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY), LIGHT)
