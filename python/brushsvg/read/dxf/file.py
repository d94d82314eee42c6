"""Load an ezdxf document from bytes, and report repairs and damage."""

from __future__ import annotations

import io

from ...errors import Error
from ..design import Notice
from .ezdxf_import import ezdxf
from .tag_filter import EntityFilter

_BINARY = b"AutoCAD Binary DXF\r\n\x1a\x00"
_MAX_NOTICES = 5
_INVALID_NUMBER = ezdxf.audit.AuditError.INVALID_FLOATING_POINT_VALUE


_INVISIBLE_REPAIRS = {  # repairs of links between the parts of a file, and of parts that are not painted
    ezdxf.audit.AuditError[name]
    for name in """CREATED_MISSING_OBJECT GROUP_ENTITIES_IN_DIFFERENT_LAYOUTS INVALID_CREASE_VALUE_COUNT
    INVALID_DICTIONARY_ENTRY INVALID_DIMSTYLE INVALID_ENTITY_HANDLE INVALID_GROUP_ENTITIES INVALID_OWNER_HANDLE
    INVALID_TABLE_HANDLE INVALID_TRANSPARENCY MISSING_PERSISTENT_REACTOR MISSING_REQUIRED_SEQEND
    ORPHANED_PAPER_SPACE_BLOCK_RECORD_ENTITY REMOVED_INVALID_DXF_OBJECT REMOVE_EMPTY_GROUP
    UNDEFINED_DIMENSION_STYLE""".split()
    if name in ezdxf.audit.AuditError.__members__
}


class _Auditor(ezdxf.audit.Auditor):
    def check_block_reference_cycles(self) -> None:
        """Do nothing: this check walks every path through nested blocks.

        The walk over the entities limits the number of blocks in its own way.
        """

    def trash(self, entity) -> None:
        """Keep drawn entities even if they are damaged, so that the walk can name them."""
        if not isinstance(entity, ezdxf.entities.DXFGraphic):
            super().trash(entity)
        elif self.fixes and str(entity) in self.fixes[-1].message:  # this fix reports the removal
            self.fixes.pop()

    def repairs(self) -> list[Notice]:
        """Return a notice for each repair that may change the painting."""
        return [
            Notice(
                str(fix.entity or "file"),
                f"repaired: {printable(fix.message).rstrip('.')}",
                code="dxf-repaired",
                about=str(fix.code),
            )
            for fix in self.fixes
            if fix.code not in _INVISIBLE_REPAIRS
        ]


def open_dxf(data: bytes) -> tuple[ezdxf.document.Drawing, list[Notice]]:
    """Load a document, and notices about its damage.

    Raises Error if the data is not a DXF or is damaged beyond repair.
    """
    if data[:4] == b"AC10" and data[4:6].isdigit():
        raise Error("the file is a DWG, not a DXF: save it as DXF in the program that made it", code="dxf-damaged")
    if b"ENTITIES" not in data:
        raise Error("the file is not a DXF, or cut short: it has no ENTITIES", code="dxf-damaged")
    read = _load_binary if data.startswith(_BINARY) else _load_text
    try:
        document, notices = read(data)
        auditor = _Auditor(document)
        auditor.run()
    except ezdxf.DXFError as problem:
        raise Error(f"the DXF is damaged beyond repair: {exception_text(problem)}", code="dxf-damaged") from None
    except Exception:  # ezdxf raises anything on arbitrary bytes
        raise Error("the DXF is damaged beyond repair, or cut short", code="dxf-damaged") from None
    problems = _summarize_problems([("file", error.message) for error in auditor.errors], damaged=False)
    return document, notices + problems + auditor.repairs()


def _load_binary(data: bytes) -> tuple[ezdxf.document.Drawing, list[Notice]]:
    return ezdxf.document.Drawing.load(ezdxf.lldxf.tagger.binary_tags_loader(data)), []


def _load_text(data: bytes) -> tuple[ezdxf.document.Drawing, list[Notice]]:
    damage = []
    if not data.rstrip(b" \t\r\n\0\x1a").endswith(b"EOF"):
        damage.append(("file", "the end of the file is missing"))
        data = _drop_last_entity(data)
    entities = EntityFilter()
    try:
        document, recovered = _load_recovered(data, entities)
        bad_numbers = any(code == _INVALID_NUMBER for code, _ in recovered.errors)
    except Exception:  # ezdxf raises anything; the strict filter below reports the damaged entities
        bad_numbers = True
    if bad_numbers:
        entities = EntityFilter(is_strict=True)
        document, recovered = _load_recovered(data, entities)
    damage += [(printable(name), f"it is damaged ({printable(why)}): left out") for name, why in entities.broken]
    damage += [("file", message) for _, message in (*recovered.errors, *recovered.fixes)]
    counts = [
        Notice(
            printable(kind),
            f"{unread_phrase(printable(kind))}: {n} {'entity' if n == 1 else 'entities'} left out",
            code="dxf-entity-unread",
        )
        for kind, n in entities.left_out.items()
    ]
    return document, _summarize_problems(damage, damaged=True) + counts


def _load_recovered(data: bytes, entities: EntityFilter) -> tuple[ezdxf.document.Drawing, ezdxf.recover.Recover]:
    """Load a document as ezdxf.recover.read() does, but without the audit."""
    recovered = ezdxf.recover.Recover.run(io.BytesIO(data), loader=entities.tags)
    document = ezdxf.document.Drawing()
    document._load_section_dict(recovered.section_dict)
    return document, recovered


def _drop_last_entity(data: bytes) -> bytes:
    """Remove the last entity of a file that was cut short: it may be incomplete."""
    lines = data.split(b"\n")
    codes = range(0, len(lines), 2)
    last = next((k for k in reversed(codes) if lines[k].strip() == b"0"), 0)
    return b"\n".join([*lines[:last], b"0", b"ENDSEC", b"0", b"EOF", b""])


def unread_phrase(kind: str) -> str:
    """Return the beginning of a sentence about entities of a type that is not read."""
    return f"{kind} is not read" + (", what it covers is painted" if kind == "WIPEOUT" else "")


def exception_text(problem: Exception) -> str:
    """Return the message of an exception of ezdxf, as the end of a sentence."""
    return printable(str(problem)).rstrip(".") or type(problem).__name__


def printable(text: str, max_length: int = 120) -> str:
    """Return text of a file for use in a sentence: one line, printable, shortened."""
    text = " ".join("".join(c if c.isprintable() or c.isspace() else "?" for c in text).split())
    return text if len(text) <= max_length else text[: max_length - 3] + "..."


def _summarize_problems(reported: list[tuple[str, str]], damaged: bool) -> list[Notice]:
    kept = [(where, printable(sentence).rstrip(".")) for where, sentence in reported[:_MAX_NOTICES]]
    if more := len(reported) - len(kept):
        kept.append(("file", f"and {more} more such problems"))
    return [Notice(where, sentence, damaged, code="dxf-repaired", about=sentence) for where, sentence in kept]
