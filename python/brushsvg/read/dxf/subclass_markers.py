"""Add the subclass markers that ezdxf needs to entities of minimal exporters.

Files of minimal exporters have newer entities, but no header, or the version R12, or no markers of subclasses (group
code 100).
"""

from __future__ import annotations

from itertools import takewhile

from .ezdxf_import import ezdxf

SUBCLASS_BY_TYPE = {
    b"HATCH": b"AcDbHatch",
    b"LEADER": b"AcDbLeader",
    b"LWPOLYLINE": b"AcDbPolyline",
    b"MLINE": b"AcDbMline",
    b"MPOLYGON": b"AcDbMPolygon",
    b"MTEXT": b"AcDbMText",
    b"SPLINE": b"AcDbSpline",
}
ENTITY_SUBCLASS = b"AcDbEntity"
FIRST_MARKED_VERSION = b"AC1012"  # the first version with markers
_MARKER_CODE = 100
_HEAD_CODES = frozenset((0, 5, 102, 330, 360))  # group codes of type and handles
# Group codes of layer, line type, colour and other properties that all graphic entities have.
_GRAPHIC_CODES = frozenset((6, 8, 48, 60, 62, 67, 370, 410, 420, 430, 440))

Tag = ezdxf.lldxf.types.DXFTag


def is_marked(entity: list[Tag]) -> bool:
    return any(tag.code == _MARKER_CODE and tag.value.strip() == ENTITY_SUBCLASS for tag in entity)


def add_markers(entity: list[Tag], subclass: bytes) -> list[Tag]:
    """Return an entity with its subclass markers. A marked entity stays as it is."""
    markers = [tag.value.strip() for tag in entity if tag.code == _MARKER_CODE]
    if markers[:2] == [ENTITY_SUBCLASS, subclass]:
        return entity
    entity = [tag for tag in entity if tag.code != _MARKER_CODE]
    head = list(takewhile(lambda tag: tag.code in _HEAD_CODES, entity))
    rest = entity[len(head) :]
    graphic = [tag for tag in rest if tag.code in _GRAPHIC_CODES]
    own = [tag for tag in rest if tag.code not in _GRAPHIC_CODES]
    return [*head, Tag(_MARKER_CODE, ENTITY_SUBCLASS), *graphic, Tag(_MARKER_CODE, subclass), *own]
