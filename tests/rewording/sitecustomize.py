"""Python starts with this where PYTHONPATH names its folder: brushsvg then speaks in other words, see rewording.py."""

import hashlib
import sys
import tempfile
from importlib.machinery import SourceFileLoader
from importlib.util import spec_from_file_location
from pathlib import Path

RULES = Path(__file__).with_name("rewording.py")
ROOT = Path(__file__).resolve().parents[2]
PACKAGE = str(ROOT / "python" / "brushsvg")
BUILT = ROOT / "build" / "reworded" / "out"  # by make test-wording, of reword_cpp.py's copy

compile_as_it_is = SourceFileLoader.source_to_code


def source_to_code(self, data, path, **settings):
    if str(path).startswith(PACKAGE):
        from rewording import reworded_module

        data = reworded_module(data, path)
    return compile_as_it_is(self, data, path, **settings)


class RewordedCore:
    """Finds the C++ module that was built of other words."""

    @staticmethod
    def find_spec(name, path=None, target=None):
        found = list(BUILT.glob("_core*.so")) if name == "brushsvg._core" else []
        return spec_from_file_location(name, found[0]) if found else None


SourceFileLoader.source_to_code = source_to_code
sys.meta_path.insert(0, RewordedCore)
# compiled modules have a folder of their own, another one for other rules
digest = hashlib.sha256(RULES.read_bytes() + Path(__file__).read_bytes()).hexdigest()[:12]
sys.pycache_prefix = str(Path(tempfile.gettempdir()) / f"brushsvg-reworded-{digest}")
