"""Newer entities as minimal exporters write them, marked as ezdxf wants them.

Such files have no header, or call themselves R12, or leave the markers of subclasses (group code 100) out.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import takewhile
from typing import BinaryIO

from .dxf_library import ezdxf

_SUBCLASS = {
    b"HATCH": b"AcDbHatch",
    b"LEADER": b"AcDbLeader",
    b"LWPOLYLINE": b"AcDbPolyline",
    b"MLINE": b"AcDbMline",
    b"MPOLYGON": b"AcDbMPolygon",
    b"MTEXT": b"AcDbMText",
    b"SPLINE": b"AcDbSpline",
}
_OF_ALL = b"AcDbEntity"
_MARKER, _FIRST_MARKED, _RAISED = 100, b"AC1012", b"AC1015"
_HEAD = frozenset((0, 5, 102, 330, 360))  # type, handles
_GRAPHIC = frozenset((6, 8, 48, 60, 62, 67, 370, 410, 420, 430, 440))  # layer, line type, colour ...

_Tag = ezdxf.lldxf.types.DXFTag


def marked_tags(stream: BinaryIO) -> Iterator[_Tag]:
    """The tags of a text file, a loader for ezdxf.recover.Recover. Files without such entities are as they were."""
    tags = list(ezdxf.recover.bytes_loader(stream))
    starts = [k for k, (code, _) in enumerate(tags) if code == 0]
    if not any(tags[k].value.strip() in _SUBCLASS for k in starts):
        return iter(tags)
    return _marked(tags, starts)


def _marked(tags: list[_Tag], starts: list[int]) -> Iterator[_Tag]:
    versions = [k + 1 for k, tag in enumerate(tags[:-1]) if tag == (9, b"$ACADVER")]
    for k in versions:
        if tags[k].value.strip() < _FIRST_MARKED:
            tags[k] = _Tag(1, _RAISED)
    if not versions:
        header = (0, b"SECTION"), (2, b"HEADER"), (9, b"$ACADVER"), (1, _RAISED), (0, b"ENDSEC")
        yield from (_Tag(*tag) for tag in header)
    yield from tags[: starts[0]]
    for begin, end in zip(starts, [*starts[1:], len(tags)], strict=True):
        subclass = _SUBCLASS.get(tags[begin].value.strip())
        entity = tags[begin:end]
        yield from entity if subclass is None else _with_markers(entity, subclass)


def _with_markers(entity: list[_Tag], subclass: bytes) -> list[_Tag]:
    markers = [tag.value.strip() for tag in entity if tag.code == _MARKER]
    if markers[:2] == [_OF_ALL, subclass]:
        return entity
    entity = [tag for tag in entity if tag.code != _MARKER]
    head = list(takewhile(lambda tag: tag.code in _HEAD, entity))
    rest = entity[len(head) :]
    graphic = [tag for tag in rest if tag.code in _GRAPHIC]
    own = [tag for tag in rest if tag.code not in _GRAPHIC]
    return [*head, _Tag(_MARKER, _OF_ALL), *graphic, _Tag(_MARKER, subclass), *own]
