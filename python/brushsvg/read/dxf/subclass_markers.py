"""Add the subclass markers that ezdxf needs to entities of minimal exporters.

Files of minimal exporters have newer entities, but no header, or the version R12, or no markers of subclasses (group
code 100).
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
_HEAD = frozenset((0, 5, 102, 330, 360))  # group codes of type and handles
_GRAPHIC = frozenset((6, 8, 48, 60, 62, 67, 370, 410, 420, 430, 440))  # codes of layer, line type, colour ...

Tag = ezdxf.lldxf.types.DXFTag


def is_marked(entity: list[Tag]) -> bool:
    return any(tag.code == _MARKER and tag.value.strip() == OF_ALL for tag in entity)


def with_markers(entity: list[Tag], subclass: bytes) -> list[Tag]:
    """Return an entity with its subclass markers. A marked entity stays as it is."""
    markers = [tag.value.strip() for tag in entity if tag.code == _MARKER]
    if markers[:2] == [OF_ALL, subclass]:
        return entity
    entity = [tag for tag in entity if tag.code != _MARKER]
    head = list(takewhile(lambda tag: tag.code in _HEAD, entity))
    rest = entity[len(head) :]
    graphic = [tag for tag in rest if tag.code in _GRAPHIC]
    own = [tag for tag in rest if tag.code not in _GRAPHIC]
    return [*head, Tag(_MARKER, OF_ALL), *graphic, Tag(_MARKER, subclass), *own]
