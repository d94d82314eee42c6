"""Newer entities as minimal exporters write them, marked as ezdxf wants them.

Such files have no header, or call themselves R12, or leave the markers of subclasses (group code 100) out.
"""

from __future__ import annotations

from itertools import takewhile

from .ezdxf_import import ezdxf

SUBCLASS = {
    b"HATCH": b"AcDbHatch",
    b"LEADER": b"AcDbLeader",
    b"LWPOLYLINE": b"AcDbPolyline",
    b"MLINE": b"AcDbMline",
    b"MPOLYGON": b"AcDbMPolygon",
    b"MTEXT": b"AcDbMText",
    b"SPLINE": b"AcDbSpline",
}
OF_ALL = b"AcDbEntity"
MARKED = b"AC1012"  # the first version with markers
_MARKER = 100
_HEAD = frozenset((0, 5, 102, 330, 360))  # type, handles
_GRAPHIC = frozenset((6, 8, 48, 60, 62, 67, 370, 410, 420, 430, 440))  # layer, line type, colour ...

Tag = ezdxf.lldxf.types.DXFTag


def is_marked(entity: list[Tag]) -> bool:
    return any(tag.code == _MARKER and tag.value.strip() == OF_ALL for tag in entity)


def with_markers(entity: list[Tag], subclass: bytes) -> list[Tag]:
    """An entity as ezdxf reads it; one that is marked stays as it is."""
    markers = [tag.value.strip() for tag in entity if tag.code == _MARKER]
    if markers[:2] == [OF_ALL, subclass]:
        return entity
    entity = [tag for tag in entity if tag.code != _MARKER]
    head = list(takewhile(lambda tag: tag.code in _HEAD, entity))
    rest = entity[len(head) :]
    graphic = [tag for tag in rest if tag.code in _GRAPHIC]
    own = [tag for tag in rest if tag.code not in _GRAPHIC]
    return [*head, Tag(_MARKER, OF_ALL), *graphic, Tag(_MARKER, subclass), *own]
