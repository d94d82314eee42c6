"""PNG files as libpng reads them without a word: it prints what it finds wrong, and stops the picture there."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator

import numpy as np

SIGNATURE = b"\x89PNG\r\n\x1a\n"
READ = (b"IHDR", b"PLTE", b"IDAT", b"IEND", b"eXIf")  # of the others none tells colours or which way is up
CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
BITS = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
LONGEST_SIDE_PX = 1_000_000  # libpng's own limit
AT_ONCE = 1 << 20
# Adam7: where each of its pictures begins, and the steps between its pixels, x, y
INTERLACED = (
    (0, 0, 8, 8),
    (4, 0, 8, 8),
    (0, 4, 4, 8),
    (2, 0, 4, 4),
    (0, 2, 2, 4),
    (1, 0, 2, 2),
    (0, 1, 1, 2),
)


def sound_png(data: bytes) -> bytes | None:
    """The file with only what is read of it; None where any of that is damaged or missing."""
    chunks = _chunks(data)
    names = [name for name, _ in chunks]
    if names[:1] != [b"IHDR"] or names[-1:] != [b"IEND"] or names.count(b"IHDR") != 1:
        return None
    image = [k for k, name in enumerate(names) if name == b"IDAT"]
    if not image or image != list(range(image[0], image[-1] + 1)) or len(chunks[0][1]) != 13:
        return None
    width, height, bits, colour, packing, filtering, interlaced = struct.unpack(">IIBBBBB", chunks[0][1])
    if not (0 < width <= LONGEST_SIDE_PX and 0 < height <= LONGEST_SIDE_PX and bits in BITS.get(colour, ())):
        return None
    if packing or filtering or interlaced > 1 or not _has_palette(chunks[: image[0]], names, bits, colour):
        return None
    rows = [
        (-(-(height - y) // down), 1 + -(-(-(-(width - x) // right) * bits * CHANNELS[colour]) // 8))
        for x, y, right, down in (INTERLACED if interlaced else ((0, 0, 1, 1),))
        if width > x and height > y
    ]
    if not _is_filled([chunks[k][1] for k in image], rows):
        return None
    return SIGNATURE + b"".join(
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body in chunks
    )


def _chunks(data: bytes) -> list[tuple[bytes, bytes]]:
    """What is read of the chunks up to the last one; empty where one that must be read is damaged or unknown."""
    found, at = [], len(SIGNATURE)
    while at + 12 <= len(data):
        (length,) = struct.unpack_from(">I", data, at)
        name, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        at += 12 + length
        is_sound = at <= len(data) and data[at - 4 : at] == struct.pack(">I", zlib.crc32(name + body))
        if name in READ and is_sound:
            found.append((name, body))
        elif not name[:1].islower():  # else it may be passed over
            return []
        if name == b"IEND":
            return found
    return []


def _has_palette(before, names: list[bytes], bits: int, colour: int) -> bool:
    """Whether there is one where colours are numbers of it, and none twice or behind the picture."""
    palettes = [body for name, body in before if name == b"PLTE"]
    if names.count(b"PLTE") != len(palettes) or len(palettes) > 1 or (palettes and colour in (0, 4)):
        return False
    if colour == 3 and not palettes:
        return False
    return all(len(body) % 3 == 0 < len(body) <= 3 * (1 << bits if colour == 3 else 256) for body in palettes)


def _is_filled(bodies: list[bytes], rows: list[tuple[int, int]]) -> bool:
    """Whether what is packed there is so many rows of so many bytes, the first of each a filter, and no more."""
    parts, behind = list(reversed(rows)), b""
    try:
        for part in _unpacked(bodies):
            behind += part
            while behind and parts:
                count, size = parts.pop()
                whole = min(count, len(behind) // size)
                if whole and np.frombuffer(behind, np.uint8, whole * size)[::size].max() > 4:
                    return False
                behind = behind[whole * size :]
                if whole < count:
                    parts.append((count - whole, size))
                    break
            if behind and not parts:
                return False
    except zlib.error:
        return False
    return not behind and not parts


def _unpacked(bodies: list[bytes]) -> Iterator[bytes]:
    """In pieces; zlib.error where it does not end where it should."""
    inflate = zlib.decompressobj()
    for body in bodies:
        for first in range(0, len(body), AT_ONCE >> 4):
            piece = body[first : first + (AT_ONCE >> 4)]
            while piece and not inflate.eof:
                yield inflate.decompress(piece, AT_ONCE)
                piece = inflate.unconsumed_tail
            if piece or inflate.unused_data:
                raise zlib.error("more behind its end")
    if not inflate.eof:
        raise zlib.error("it has no end")
