"""Find the fonts of this machine for the text of a DXF.

Font files are found by their names, and opened only if a text needs them.
"""

from __future__ import annotations

import os
import platform
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from pathlib import Path, PureWindowsPath

from .ezdxf_import import ezdxf
from .file import printable

_fonts = ezdxf.fonts.fonts
_font_manager = ezdxf.fonts.font_manager

_MAX_FILES = 50_000  # files that are searched; a font beyond them counts as missing
# Endings of file names, without hyphens and blanks, by (bold, italic). Windows uses the short endings.
_STYLE_ENDINGS = {
    (False, False): ("", "regular", "book", "roman"),
    (True, False): ("bold", "bd", "b"),
    (False, True): ("italic", "oblique", "i"),
    (True, True): ("bolditalic", "boldoblique", "bi", "z"),
}


class NoFontError(Exception):
    """The machine has no usable font."""


@dataclass(frozen=True)
class Font:
    """A font file.

    name: the name for messages; path: of the file; why: the reason why it replaces the requested font, "" if it is
    the requested font.
    """

    name: str
    path: Path
    why: str = ""

    def ezdxf_font(self, cap_height: float, width_factor: float = 1.0):
        """Return the font as an AbstractFont of ezdxf."""
        font = _fonts.sideload_ttf(self.path, cap_height)
        font.width_factor = width_factor
        return font

    def missing_glyphs(self, text: str) -> list[str]:
        """Return the characters of a text for which the font has no glyph."""
        known = self.ezdxf_font(1.0).glyph_cache.cmap
        return [c for c in dict.fromkeys(text) if not c.isspace() and ord(c) not in known]


class Fonts:
    """The fonts of text styles, or the fonts that replace them."""

    def __init__(self, styles):
        self._styles = styles
        self._font_cache: dict[tuple, Font] = {}

    def face(self, style_name: str):
        """Return the FontFace of ezdxf that a text style asks for."""
        known = style_name in self._styles
        style = self._styles.get(style_name) if known else ezdxf.entities.Textstyle()
        family, italic, bold = style.get_extended_font_data()
        slant, weight = "Italic" if italic else "Regular", 700 if bold else 400
        return _fonts.FontFace(style.dxf.font, family, slant, weight)

    def font(self, face) -> Font:
        """Return the font for a FontFace. Raises NoFontError if the machine has no font."""
        key = face.filename, face.family, face.is_bold, face.is_italic
        if key not in self._font_cache:
            self._font_cache[key] = self._find_font(face)
        return self._font_cache[key]

    def _find_font(self, face) -> Font:
        for name in _candidate_file_names(face):
            if (path := self._files_by_name.get(name)) and (font := _load_font(path)):
                return font
        for stem in _candidate_stems(face):
            if (path := self._files_by_stem.get(stem)) and (font := _load_font(path)):
                return font
        if self._fallback_font is None:
            raise NoFontError
        name = PureWindowsPath(face.filename).name
        if name and not face.family and _fonts.is_shx_font_name(name):
            why = "the drawing's SHX fonts are no strokes here"
        else:
            why = f"there is no font {printable(face.family or name, 40)} here"
        return Font(self._fallback_font.name, self._fallback_font.path, why)

    @cached_property
    def _files_by_name(self) -> dict[str, Path]:
        """Font files by their names in lower case.

        If two files have the same name, the first in ezdxf's order of folders counts.
        """
        folders = _font_manager.FONT_DIRECTORIES.get(platform.system(), _font_manager.LINUX_FONT_DIRS)
        files = (path for folder in folders for path in _walk_files(os.path.expanduser(folder)))
        paths_by_name: dict[str, Path] = {}
        for path in islice(files, _MAX_FILES):
            if path.suffix.lower() in _font_manager.SUPPORTED_TTF_TYPES:
                paths_by_name.setdefault(path.name.lower(), path)
        return paths_by_name

    @cached_property
    def _files_by_stem(self) -> dict[str, Path]:
        return {
            _alphanumeric(Path(name).stem): self._files_by_name[name]
            for name in sorted(self._files_by_name, reverse=True)
        }

    @cached_property
    def _fallback_font(self) -> Font | None:
        """A font that looks like Arial, or any upright sans serif font."""
        names = [name.lower() for name in _font_manager.DEFAULT_FONTS]
        names += [
            name
            for name in sorted(self._files_by_name)
            if _alphanumeric(Path(name).stem).endswith(("sans", "sansregular"))
        ]
        paths = (self._files_by_name[name] for name in names if name in self._files_by_name)
        return next(filter(None, map(_load_font, paths)), None)


def _walk_files(folder: str):
    for place, folders, names in os.walk(folder):
        folders.sort()
        yield from (Path(place, name) for name in sorted(names))


def _load_font(path: Path) -> Font | None:
    try:
        font = _fonts.sideload_ttf(path, 1.0)
        names = font.glyph_cache.font["name"]
        name = names.getBestFullName() or names.getBestFamilyName() or path.stem
        return Font(printable(name, 40), path)
    except Exception:  # fontTools raises anything on a file that is not a font
        return None


def _candidate_file_names(face) -> list[str]:
    name = PureWindowsPath(face.filename).name.lower()
    return [name, f"{name}.ttf", _fonts.map_shx_to_ttf(name).lower()] if name else []


def _candidate_stems(face) -> list[str]:
    family = _alphanumeric(face.family)
    italic = face.is_italic or face.is_oblique
    return [family + ending for ending in _STYLE_ENDINGS[face.is_bold, italic]] if family else []


def _alphanumeric(name: str) -> str:
    return "".join(c for c in name.lower() if c.isalnum())
