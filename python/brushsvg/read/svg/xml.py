"""Parse XML safely: nothing is fetched, and nothing can inflate itself.

An entity bomb is stopped before it grows. Entities that contain entities are refused, and the size of the others is
bounded beforehand by (number of references) x (longest entity). Attribute defaults are bounded in the same way.
Nested elements need no recursion, here or in the walk over the tree.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
import zlib
from dataclasses import dataclass
from xml.parsers import expat

from ...errors import Error

# Characters to which all entities, or all attribute defaults, may grow. Drawing programs declare a dozen short entities
# and use each once per element, which is far below a megabyte.
EXPANSION_LIMIT = 10_000_000
_MAX_ELEMENTS = 1_000_000  # ten times the number of elements that can be painted
_MAX_UNPACKED_BYTES = 64_000_000  # bytes; path data may have 10 million characters


@dataclass(frozen=True)
class Document:
    """A parsed document.

    root: tags are "{namespace}name"; instructions: names of the processing instructions; comments: the first 10.
    """

    root: ET.Element
    instructions: list[str]
    comments: list[str]


# First bytes of other files that users pass as drawings. Illustrator's .ai is a PDF.
_OTHER_FORMATS = {
    b"%PDF": "a PDF",
    b"%!PS": "a PostScript file",
    b"\x89PNG": "a PNG picture",
    b"\xff\xd8\xff": "a JPEG picture",
    b"PK\x03\x04": "a ZIP archive",
    b"AutoCAD Binary DXF": "a DXF",
}


def parse_xml(data: bytes) -> Document:
    """Parse a document, which may be compressed (SVGZ).

    Raises Error, with the line if it is known, if the data is not XML, reads other files or inflates itself.
    """
    if not data.strip():
        raise Error("the file is empty", code="file-empty")
    data = _unpack(data) if data.startswith(b"\x1f\x8b") else data
    if kind := next((kind for begin, kind in _OTHER_FORMATS.items() if data.startswith(begin)), None):
        raise Error(f"this is {kind}, not an SVG: export the drawing as SVG", code="not-xml")
    data, encoding = _decode(data)
    parser = expat.ParserCreate(encoding, namespace_separator="}")
    parser.buffer_text = True
    builder = ET.TreeBuilder()
    instructions: list[str] = []
    comments: list[str] = []
    names: dict[str, str] = {}
    default_length = 0

    def position() -> str:
        return f"line {parser.CurrentLineNumber}"

    def qualified(name: str) -> str:
        if name not in names:
            names[name] = "{" + name if "}" in name else name
        return names[name]

    elements = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal elements
        elements += 1
        if elements > _MAX_ELEMENTS:
            raise Error(f"{position()}: the document has more than {_MAX_ELEMENTS} elements", code="drawing-too-large")
        builder.start(qualified(tag), {qualified(name): value for name, value in attributes.items()})

    def entity(name, is_parameter, value, _base, system_id, _public_id, _notation) -> None:
        if system_id is not None:
            raise Error(f"{position()}: entity {name!r} is in another file, which is not read", code="xml-entity")
        if is_parameter or re.search("&[^#]", value):
            sentence = f"{position()}: entity {name!r} is built from other entities, which is refused"
            raise Error(sentence, code="xml-entity")
        limit_growth("entities", data.count(b"&") * len(value))

    def attribute_default(_element, _name, _type, default, _required) -> None:
        nonlocal default_length
        default_length += len(default or "")
        limit_growth("attribute defaults", data.count(b"<") * default_length)

    def limit_growth(content: str, length: int) -> None:
        if length > EXPANSION_LIMIT:
            sentence = (
                f"{position()}: the document's {content} could grow to {length} characters, "
                f"beyond the limit of {EXPANSION_LIMIT}"
            )
            raise Error(sentence, value=length, range=(0, EXPANSION_LIMIT), code="xml-entity")

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda tag: builder.end(qualified(tag))
    parser.CharacterDataHandler = builder.data
    parser.EntityDeclHandler = entity
    parser.AttlistDeclHandler = attribute_default
    parser.ProcessingInstructionHandler = lambda target, _text: instructions.append(target)
    parser.CommentHandler = lambda text: comments.append(text[:1000]) if len(comments) < 10 else None
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        reason = expat.errors.messages.get(error.code, "unreadable")
        raise Error(
            f"this is not XML: {reason} in line {error.lineno}, column {error.offset + 1}", code="not-xml"
        ) from None
    except (LookupError, ValueError) as error:
        if isinstance(error, Error):
            raise
        raise Error(f"this is not XML that can be read: {error}", code="not-xml") from None
    return Document(builder.close(), instructions, comments)


# Encodings that expat cannot decode: the label, and the codec that browsers use (WHATWG Encoding Standard).
_MULTI_BYTE_CODECS = {
    "gb2312": "gb18030",
    "gbk": "gb18030",
    "gb18030": "gb18030",
    "big5": "big5hkscs",
    "shift_jis": "cp932",
    "windows-31j": "cp932",
    "euc-jp": "euc_jp",
    "iso-2022-jp": "iso2022_jp",
    "euc-kr": "cp949",
}
_DECLARED = re.compile(rb"""\s*<\?xml\s[^>]*?encoding\s*=\s*["']([A-Za-z0-9._-]+)""")


def _decode(data: bytes) -> tuple[bytes, str | None]:
    """Convert encodings with several bytes per character to UTF-8 ("utf-8"), or return the data and None."""
    declared = _DECLARED.match(data[:200])
    codec = _MULTI_BYTE_CODECS.get(declared[1].decode().lower()) if declared else None
    if codec is None:
        return data, None
    try:
        return data.decode(codec).encode(), "utf-8"
    except UnicodeDecodeError as error:
        sentence = f"the file says that it is in {declared[1].decode()}, but byte {error.start + 1} is not"
        raise Error(f"{sentence}; save it in UTF-8", code="not-xml") from None


def _unpack(data: bytes) -> bytes:
    """Return the content of a compressed file (SVGZ)."""
    unpacking = zlib.decompressobj(wbits=31)
    try:
        plain = unpacking.decompress(data, _MAX_UNPACKED_BYTES + 1)
    except zlib.error:
        raise Error("the file is compressed (SVGZ), but what it holds is damaged", code="svgz-damaged") from None
    if len(plain) > _MAX_UNPACKED_BYTES:
        sentence = f"the file is compressed (SVGZ) and unpacks to more than {_MAX_UNPACKED_BYTES} bytes"
        raise Error(sentence, code="file-too-large")
    if not unpacking.eof:
        raise Error("the file is compressed (SVGZ) and cut short", code="svgz-damaged")
    return plain
