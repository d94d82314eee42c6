"""Import ezdxf without a scan of all fonts or a cache in the user's home.

On import, ezdxf reads all fonts of the machine unless it finds its font cache. This takes seconds, and the results
depend on the machine. Here it finds an empty cache in a temporary folder. A program that also draws text with ezdxf
gets the fonts back with ezdxf.fonts.fonts.load().
"""

from __future__ import annotations

import logging
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_HOMES = ("XDG_CACHE_HOME", "XDG_CONFIG_HOME")
_NO_FONTS = '{"version": 2, "font-faces": []}'


@contextmanager
def _empty_home() -> Iterator[None]:
    before = {name: os.environ.get(name) for name in _HOMES}
    with tempfile.TemporaryDirectory() as folder:
        cache = Path(folder, "ezdxf", "font_manager_cache.json")
        cache.parent.mkdir()
        cache.write_text(_NO_FONTS, encoding="utf-8")
        os.environ.update(dict.fromkeys(_HOMES, folder))
        try:
            yield
        finally:
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value


with _empty_home():
    import ezdxf
    import ezdxf.addons.mtxpl
    import ezdxf.addons.text2path
    import ezdxf.audit
    import ezdxf.colors
    import ezdxf.document
    import ezdxf.entities
    import ezdxf.entities.factory
    import ezdxf.fonts.font_manager
    import ezdxf.fonts.fonts
    import ezdxf.layouts
    import ezdxf.lldxf.extendedtags
    import ezdxf.lldxf.tagger
    import ezdxf.lldxf.tags
    import ezdxf.lldxf.types
    import ezdxf.math
    import ezdxf.path
    import ezdxf.protocols
    import ezdxf.recover
    import ezdxf.tools.text
    import ezdxf.tools.text_layout
    import ezdxf.xclip

# The log of ezdxf becomes notices. Without a handler the standard library would print it.
logging.getLogger("ezdxf").addHandler(logging.NullHandler())

__all__ = ["ezdxf"]
