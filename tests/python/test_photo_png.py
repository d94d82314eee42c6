"""PNG files as photographs: what libpng would print is told in a sentence of ours, or passed over as it may be."""

import struct
import zlib

import cv2
import numpy as np
import pytest

from brushsvg.errors import Error
from brushsvg.scan.photo import read_photo
from brushsvg.scan.png import SIGNATURE

PIXELS = (np.arange(40 * 30 * 3).reshape(30, 40, 3) * 7 % 251).astype(np.uint8)
WHOLE = cv2.imencode(".png", PIXELS)[1].tobytes()
ROWS = b"".join(b"\0" + row[:, ::-1].tobytes() for row in PIXELS)


def chunk(name: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))


def png(packed: bytes, *more: bytes, bits=8, colour=2, interlaced=0, size=(40, 30)) -> bytes:
    head = struct.pack(">IIBBBBB", *size, bits, colour, 0, 0, interlaced)
    return SIGNATURE + chunk(b"IHDR", head) + b"".join(more) + chunk(b"IDAT", packed) + chunk(b"IEND", b"")


SOUND = {
    "as it is": (WHOLE, PIXELS),
    "made here": (png(zlib.compress(ROWS)), PIXELS),
    "with what is only told": (
        png(
            zlib.compress(ROWS),
            chunk(b"iCCP", b"x\0\0no profile"),
            chunk(b"gAMA", b"\0"),
            chunk(b"sRGB", b"\7"),
            chunk(b"tRNS", b"1"),
        ),
        PIXELS,
    ),
    "with more behind its end": (WHOLE + b"more", PIXELS),
    "interlaced": (png(zlib.compress(bytes(55)), interlaced=1, size=(3, 5)), np.zeros((5, 3, 3))),
    "a palette": (
        png(zlib.compress(bytes(30 * 41)), chunk(b"PLTE", b"\1\2\3"), colour=3),
        np.full((30, 40, 3), (3, 2, 1)),
    ),
    "one bit": (png(zlib.compress(bytes(30 * 6)), bits=1, colour=0), np.zeros((30, 40, 3))),
    "sixteen bits": (png(zlib.compress(bytes(30 * 321)), bits=16, colour=6), np.zeros((30, 40, 3))),
}
DAMAGED = {
    "half of it": WHOLE[: len(WHOLE) // 2],
    "without its end": WHOLE[:-12],
    "its head alone": WHOLE[:33],
    "a bit of a chunk": WHOLE[:60] + bytes([WHOLE[60] ^ 1]) + WHOLE[61:],
    "a chunk that must be known": png(zlib.compress(ROWS), chunk(b"XXXX", b"")),
    "nothing packed": png(b""),
    "not packed": png(b"junk" * 9),
    "a row too few": png(zlib.compress(ROWS[:-121])),
    "a byte too many": png(zlib.compress(ROWS + b"\0")),
    "more than is packed": png(zlib.compress(ROWS) + b"\0"),
    "packed without an end": png(zlib.compress(ROWS)[:-4]),
    "no such filter": png(zlib.compress(b"\x09" + ROWS[1:])),
    "no such colours": png(zlib.compress(ROWS), bits=3),
    "no palette": png(zlib.compress(bytes(30 * 41)), colour=3),
    "larger than anything": png(b"", size=(1 << 30, 1 << 30)),
}


@pytest.mark.parametrize("name", SOUND)
def test_a_sound_png_is_read_without_a_word(capfd, name):
    data, pixels = SOUND[name]
    assert np.array_equal(read_photo(data), pixels)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", DAMAGED)
def test_a_damaged_png_is_refused_in_one_sentence(capfd, name):
    with pytest.raises(Error, match="the PNG file is damaged, or not whole") as refused:
        read_photo(DAMAGED[name])
    assert refused.value.code == "photo-format"
    assert capfd.readouterr() == ("", "")
