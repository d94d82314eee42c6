"""Load the core that tools/test_variants.py tests; Python runs this file first."""

import importlib.abc
import importlib.machinery
import importlib.util
import os
import sys

CORE = os.environ.get("BRUSHSVG_VARIANT_CORE", "")


class CoreOfVariant(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        return importlib.util.spec_from_file_location(name, CORE) if name == "brushsvg._core" else None


if CORE.endswith(importlib.machinery.EXTENSION_SUFFIXES[0]):  # not a core for another Python
    sys.meta_path.insert(0, CoreOfVariant())
