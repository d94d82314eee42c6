"""Mutators that know the parts of an input: words and numbers, lines, pixels."""

from __future__ import annotations

import copy
import json
import random
import re
from xml.etree import ElementTree

from targets import Target

ODD_NUMBERS = (
    *"0 -0 1 -1 2 0.5 1e-9 1e9 -1e9 1e308 1e400 -1e400 nan inf 4294967296 -2147483649 9007199254740993".split(),
    "1" * 400,
    "0." + "0" * 330 + "1",
)
# A word, a number or a single other character.
PART = re.compile(rb"[A-Za-z_$-]+|[0-9]+(?:\.[0-9]*)?(?:[eE][+-]?[0-9]+)?|\s+|.", re.DOTALL)
MOST_CHANGES = 4


def change_parts(data: bytes, target: Target, seeds: list[bytes], choose: random.Random) -> bytes:
    """Remove, double, move or replace one word, number or character."""
    parts = PART.findall(data)
    others = PART.findall(choose.choice(seeds))
    for _ in range(choose.randint(1, MOST_CHANGES)):
        at = choose.randrange(len(parts) + 1)
        kind = choose.randrange(7)
        if kind == 0 and target.words:
            parts.insert(at, choose.choice(target.words).encode())
        elif kind == 1 and parts:
            numbers = [k for k, part in enumerate(parts) if part[:1].isdigit()]
            if numbers:
                parts[choose.choice(numbers)] = choose.choice(ODD_NUMBERS).encode()
        elif kind == 2 and parts:
            del parts[at : at + choose.randint(1, 8)]
        elif kind == 3 and parts:
            start = choose.randrange(len(parts))
            parts[at:at] = parts[start : start + choose.randint(1, 30)]
        elif kind == 4 and others:
            start = choose.randrange(len(others))
            parts[at:at] = others[start : start + choose.randint(1, 30)]
        elif kind == 5 and parts and target.words:
            parts[min(at, len(parts) - 1)] = choose.choice(target.words).encode()
        elif kind == 6 and parts:
            numbers = [k for k, part in enumerate(parts) if part[:1].isdigit()]
            if numbers:
                parts[choose.choice(numbers)] = f"{choose.uniform(-100, 100):.3f}".encode()
    return b"".join(parts)


def change_lines(data: bytes, seeds: list[bytes], choose: random.Random) -> bytes:
    """Remove, double or move some lines, or insert lines of a seed."""
    lines = data.split(b"\n")
    others = choose.choice(seeds).split(b"\n")
    at, start = choose.randrange(len(lines) + 1), choose.randrange(len(lines))
    count = choose.randint(1, 5)
    kind = choose.randrange(4)
    if kind == 0:
        del lines[start : start + count]
    elif kind == 1:
        lines[at:at] = lines[start : start + count]
    elif kind == 2:
        taken = lines[start : start + count]
        del lines[start : start + count]
        lines[min(at, len(lines)) : min(at, len(lines))] = taken
    else:
        start = choose.randrange(len(others))
        lines[at:at] = others[start : start + count]
    return b"\n".join(lines)


def change_json(data: bytes, target: Target, seeds: list[bytes], choose: random.Random) -> bytes:
    """Remove, double or replace a value of a JSON document."""
    document = _parsed(data, choose.choice(seeds), json.loads)
    for _ in range(choose.randint(1, MOST_CHANGES)):
        holders = [value for value in _values(document) if value and isinstance(value, (dict, list))]
        if not holders:
            break
        holder = choose.choice(holders)
        key = choose.choice(list(holder) if isinstance(holder, dict) else range(len(holder)))
        kind = choose.randrange(5)
        if kind == 0:
            del holder[key]
        elif kind == 1:
            holder[key] = choose.choice(
                (
                    None,
                    True,
                    -1,
                    0,
                    0.5,
                    1e9,
                    -1e308,
                    float("inf"),
                    float("nan"),
                    2**70,
                    "",
                    "a" * 5000,
                    [],
                    {},
                    [[]],
                )
            )
        elif kind == 2:
            holder[key] = copy.deepcopy(choose.choice(list(_values(document))))
        elif kind == 3 and isinstance(holder, list):
            holder.insert(key, copy.deepcopy(holder[key]))
        elif isinstance(holder[key], (int, float)):
            holder[key] = choose.choice((choose.uniform(-100, 100), choose.randint(-3, 9)))
        elif isinstance(holder, dict) and target.words:
            holder[choose.choice(target.words)] = holder.pop(key)
        if len(json.dumps(document)) > 4 * target.most_bytes:
            break
    return json.dumps(document).encode()


def _values(document):
    """Yield the document and all values in it."""
    waiting = [document]
    while waiting:
        value = waiting.pop()
        yield value
        waiting += value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()


def change_xml(data: bytes, target: Target, seeds: list[bytes], choose: random.Random) -> bytes:
    """Remove, double, move or change an element or attribute of an XML document."""
    root = _parsed(data, choose.choice(seeds), ElementTree.fromstring)
    other = _parsed(choose.choice(seeds), choose.choice(seeds), ElementTree.fromstring)
    for _ in range(choose.randint(1, MOST_CHANGES)):
        nodes = list(root.iter())
        if len(nodes) > 300:
            break
        node, kind = choose.choice(nodes), choose.randrange(6)
        names = list(node.attrib)
        if kind == 0 and len(node):
            node.remove(choose.choice(list(node)))
        elif kind == 1:
            node.append(copy.deepcopy(choose.choice(list(choose.choice((root, other)).iter()))))
        elif kind == 2 and names:
            name = choose.choice(names)
            changed = change_parts(node.attrib[name].encode(), target, [b"1 2 3", b"none"], choose)
            node.attrib[name] = "".join(c for c in changed.decode("latin-1") if c.isprintable())
        elif kind == 3:
            giver = choose.choice(list(other.iter()))
            node.attrib.update(giver.attrib)
        elif kind == 4 and names:
            del node.attrib[choose.choice(names)]
        elif kind == 5:
            node.tag = choose.choice(list(other.iter())).tag
    return ElementTree.tostring(root)


def _parsed(data: bytes, seed: bytes, parse):
    """Parse the data, otherwise the seed, otherwise an empty document."""
    for each in (data, seed):
        try:
            found = parse(each)
        except (ValueError, LookupError, ElementTree.ParseError, RecursionError):
            continue
        return found
    return parse(b"<svg/>" if parse is ElementTree.fromstring else b"{}")


def change_pixels(data: bytes, seeds: list[bytes], choose: random.Random) -> bytes:
    """Change the pixels of a picture.

    Changed bytes of a compressed picture hardly ever give another valid picture.
    """
    import cv2
    import numpy as np

    pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
    if pixels is None or pixels.size == 0:
        pixels = cv2.imdecode(np.frombuffer(choose.choice(seeds), np.uint8), cv2.IMREAD_COLOR)
    rows, columns = pixels.shape[:2]
    places = [(choose.randrange(columns), choose.randrange(rows)) for _ in range(4)]
    shade = (choose.randrange(256),) * 3
    kind = choose.randrange(8)
    if kind == 0:
        cv2.line(pixels, places[0], places[1], shade, choose.randint(1, 9))
    elif kind == 1:
        cv2.rectangle(pixels, places[0], places[1], shade, -1)
    elif kind == 2:
        pixels = cv2.flip(pixels, choose.choice((-1, 0, 1)))
    elif kind == 3:
        matrix = cv2.getRotationMatrix2D(places[0], choose.uniform(-30, 30), choose.uniform(0.5, 1.5))
        pixels = cv2.warpAffine(pixels, matrix, (columns, rows), borderValue=(235, 235, 235))
    elif kind == 4:
        noise = np.random.default_rng(choose.getrandbits(32)).normal(0, choose.uniform(1, 60), pixels.shape)
        pixels = np.clip(pixels + noise, 0, 255).astype(np.uint8)
    elif kind == 5:
        pixels = cv2.GaussianBlur(pixels, (0, 0), choose.uniform(0.3, 5))
    elif kind == 6:
        pixels = 255 - pixels if choose.random() < 0.3 else (pixels * choose.uniform(0.0, 1.0)).astype(np.uint8)
    else:
        (left, top), (right, bottom) = np.sort(places[:2], axis=0)
        pixels = pixels[top : bottom + 1, left : right + 1]
    return cv2.imencode(choose.choice((".png", ".jpg", ".bmp")), np.ascontiguousarray(pixels))[1].tobytes()


def change_bytes(data: bytes, choose: random.Random) -> bytes:
    """Change, add or remove a few bytes where libFuzzer is not available."""
    changed = bytearray(data)
    for _ in range(choose.randint(1, 2 * MOST_CHANGES)):
        at, kind = choose.randrange(len(changed) + 1), choose.randrange(4)
        if kind == 0:
            changed[at:at] = choose.randbytes(choose.randint(1, 4))
        elif kind == 1:
            del changed[at : at + choose.randint(1, 8)]
        elif kind == 2 and at < len(changed):
            changed[at] ^= 1 << choose.randrange(8)
        elif at < len(changed):
            changed[at] = choose.choice((0, 1, 127, 128, 255, 10, 32))
    return bytes(changed)


def structured(data: bytes, target: Target, seeds: list[bytes], choose: random.Random) -> bytes:
    """Make one change that suits the target."""
    if target.form == "picture":
        return change_pixels(data, seeds, choose)
    if target.form == "lines" and choose.random() < 0.4:
        return change_lines(data, seeds, choose)
    if target.form == "json" and choose.random() < 0.7:
        return change_json(data, target, seeds, choose)
    if target.form == "xml" and choose.random() < 0.7:
        return change_xml(data, target, seeds, choose)
    return change_parts(data, target, seeds, choose)
