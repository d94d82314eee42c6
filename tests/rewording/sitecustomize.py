"""Python starts with this where PYTHONPATH names its folder: brushsvg then speaks in other words, see rewording.py."""

import hashlib
import sys
import tempfile
from importlib.machinery import SourceFileLoader
from pathlib import Path

RULES = Path(__file__).with_name("rewording.py")
PACKAGE = str(Path(__file__).resolve().parents[2] / "python" / "brushsvg")

compile_as_it_is = SourceFileLoader.source_to_code


def source_to_code(self, data, path, **settings):
    if str(path).startswith(PACKAGE):
        from rewording import reworded_module

        data = reworded_module(data, path)
    return compile_as_it_is(self, data, path, **settings)


SourceFileLoader.source_to_code = source_to_code
# compiled modules have a folder of their own, another one for other rules
digest = hashlib.sha256(RULES.read_bytes() + Path(__file__).read_bytes()).hexdigest()[:12]
sys.pycache_prefix = str(Path(tempfile.gettempdir()) / f"brushsvg-reworded-{digest}")
