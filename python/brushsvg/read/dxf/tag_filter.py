"""Filter the entities of a text DXF before ezdxf builds them.

ezdxf refuses a whole file because of one entity that it cannot build, and drops others without a message. So this
filter removes and counts the entities that brushsvg does not read. If a file cannot be loaded otherwise, it also
removes damaged entities. entity_curves converts the rest.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import takewhile
from typing import BinaryIO

from .ezdxf_import import ezdxf

# Subclass markers (group code 100) that ezdxf needs in newer entities. Minimal exporters leave them out.
_SUBCLASS_BY_TYPE = {
    b"HATCH": b"AcDbHatch",
    b"LEADER": b"AcDbLeader",
    b"LWPOLYLINE": b"AcDbPolyline",
    b"MLINE": b"AcDbMline",
    b"MPOLYGON": b"AcDbMPolygon",
    b"MTEXT": b"AcDbMText",
    b"SPLINE": b"AcDbSpline",
}
_ENTITY_SUBCLASS = b"AcDbEntity"
_FIRST_MARKED_VERSION = b"AC1012"  # the first version with markers
_MARKER_CODE = 100
_HEAD_CODES = frozenset((0, 5, 102, 330, 360))  # group codes of type and handles
# Group codes of layer, line type, colour and other properties that all graphic entities have.
_GRAPHIC_CODES = frozenset((6, 8, 48, 60, 62, 67, 370, 410, 420, 430, 440))
Tag = ezdxf.lldxf.types.DXFTag
_R12_NAMES = "ARC ATTDEF ATTRIB BLOCK CIRCLE DIMENSION ENDBLK INSERT LINE POINT POLYLINE SEQEND SOLID TEXT TRACE VERTEX"
_R12_TYPES = frozenset([*_R12_NAMES.encode().split(), b"3DFACE"])
_UNMARKED_TYPES = frozenset((b"ELLIPSE", b"RAY", b"XLINE"))  # ezdxf also reads these without markers
_MARKED_ONLY_TYPES = frozenset(
    b"ACAD_PROXY_ENTITY ARC_DIMENSION HELIX LARGE_RADIAL_DIMENSION MLEADER MULTILEADER".split()
)
_NEWER_TYPES = _UNMARKED_TYPES | _MARKED_ONLY_TYPES | _SUBCLASS_BY_TYPE.keys()
_PART_TYPES = frozenset((b"ATTRIB", b"SEQEND", b"VERTEX"))  # these belong to the entity before them
_SILENT_TYPES = frozenset((b"VIEWPORT",))
_FLOAT_CODES = frozenset((*range(10, 60), *range(140, 150), *range(210, 240)))
_END_TAG = Tag(0, b"EOF")


@dataclass
class EntityFilter:
    """A loader for ezdxf.recover.Recover that filters entities.

    is_strict: remove damaged entities, too.
    left_out: number of removed entities by type, because the type is not read.
    broken: (name, reason) of the removed damaged entities.
    """

    is_strict: bool = False
    left_out: Counter[str] = field(default_factory=Counter)
    broken: list[tuple[str, str]] = field(default_factory=list)
    _number: int = 0

    def tags(self, stream: BinaryIO) -> Iterator[Tag]:
        tags = list(ezdxf.recover.bytes_loader(stream))
        starts = [k for k, (code, _) in enumerate(tags) if code == 0]
        kept = [part for whole in self._readable_entities(tags, starts) for part in whole]
        has_new = any(part[0].value.strip() in _NEWER_TYPES for part in kept)
        yield from (_with_newer_version(tags[: starts[0]] if starts else tags, kept) if has_new else _flatten(kept))

    def _readable_entities(self, tags: list[Tag], starts: list[int]) -> Iterator[list[list[Tag]]]:
        """Yield the tags between group codes 0, and each entity together with its parts."""
        section, whole = b"", []
        for begin, end in zip(starts, [*starts[1:], len(tags)], strict=True):
            part, kind = tags[begin:end], tags[begin].value.strip()
            if kind == b"SECTION":
                section = part[1].value.strip() if len(part) > 1 else b""
            drawn = section in (b"ENTITIES", b"BLOCKS") and kind not in (b"SECTION", b"ENDSEC", b"EOF")
            if whole and not (drawn and kind in _PART_TYPES):
                yield from self._undamaged(whole)
                whole = []
            if not drawn:
                yield [part]
            elif whole or self._is_read(kind, part):
                whole.append(_add_markers(part, _SUBCLASS_BY_TYPE[kind]) if kind in _SUBCLASS_BY_TYPE else part)
        if whole:
            yield from self._undamaged(whole)

    def _is_read(self, kind: bytes, part: list[Tag]) -> bool:
        if kind in _R12_TYPES or kind in _UNMARKED_TYPES or kind in _SUBCLASS_BY_TYPE:
            return True
        if kind in _MARKED_ONLY_TYPES and _is_marked(part):
            return True
        if kind not in _SILENT_TYPES:
            self.left_out[kind.decode(errors="replace")] += 1
        return False

    def _undamaged(self, whole: list[list[Tag]]) -> Iterator[list[list[Tag]]]:
        self._number += 1
        if self.is_strict and (why := _find_fault(whole)):
            handle = next((tag.value for tag in whole[0] if tag.code == 5), b"")
            name = b"-".join((whole[0][0].value.strip(), handle.strip() or b"%d" % self._number))
            self.broken.append((name.decode(errors="replace"), why))
        else:
            yield whole


def _flatten(parts: list[list[Tag]]) -> Iterator[Tag]:
    return (tag for part in parts for tag in part)


def _with_newer_version(before: list[Tag], parts: list[list[Tag]]) -> Iterator[Tag]:
    """Yield the tags of a file with newer entities, with a version that allows them."""
    tags = [*before, *_flatten(parts)]
    versions = [k + 1 for k, tag in enumerate(tags[:-1]) if tag == (9, b"$ACADVER")]
    for k in versions:
        if tags[k].value.strip() < _FIRST_MARKED_VERSION:
            tags[k] = Tag(1, b"AC1015")
    if not versions:
        header = (0, b"SECTION"), (2, b"HEADER"), (9, b"$ACADVER"), (1, b"AC1015"), (0, b"ENDSEC")
        yield from (Tag(*tag) for tag in header)
    yield from tags


def _find_fault(whole: list[list[Tag]]) -> str:
    """Return the reason why ezdxf cannot build an entity from its tags, "" if it can."""
    for part in whole:
        for code, value in part:
            if code in _FLOAT_CODES and not _is_number(value):
                return f"{value.decode(errors='replace')!r} at group code {code} is not a number"
        try:
            tags = ezdxf.recover.safe_tag_loader(None, lambda _, part=part: iter([*part, _END_TAG]))
            ezdxf.entities.factory.load(ezdxf.lldxf.extendedtags.ExtendedTags(ezdxf.lldxf.tags.Tags(list(tags)[:-1])))
        except Exception as problem:  # ezdxf raises anything on arbitrary bytes
            return str(problem).rstrip(".")
    return ""


def _is_number(value: bytes) -> bool:
    try:
        float(value)
    except ValueError:
        return False
    return True


def _is_marked(entity: list[Tag]) -> bool:
    return any(tag.code == _MARKER_CODE and tag.value.strip() == _ENTITY_SUBCLASS for tag in entity)


def _add_markers(entity: list[Tag], subclass: bytes) -> list[Tag]:
    """Return an entity with its subclass markers. A marked entity stays as it is."""
    markers = [tag.value.strip() for tag in entity if tag.code == _MARKER_CODE]
    if markers[:2] == [_ENTITY_SUBCLASS, subclass]:
        return entity
    entity = [tag for tag in entity if tag.code != _MARKER_CODE]
    head = list(takewhile(lambda tag: tag.code in _HEAD_CODES, entity))
    rest = entity[len(head) :]
    graphic = [tag for tag in rest if tag.code in _GRAPHIC_CODES]
    own = [tag for tag in rest if tag.code not in _GRAPHIC_CODES]
    return [*head, Tag(_MARKER_CODE, _ENTITY_SUBCLASS), *graphic, Tag(_MARKER_CODE, subclass), *own]
