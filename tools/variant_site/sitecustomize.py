"""Load the core and the Highway target that tools/test_variants.py tests; Python runs this file first."""

import contextlib
import ctypes
import importlib.abc
import importlib.machinery
import importlib.util
import os
import sys

CORE = os.environ.get("BRUSHSVG_VARIANT_CORE", "")
HIGHWAY_BIT = os.environ.get("BRUSHSVG_VARIANT_HIGHWAY_BIT", "")


class CoreOfVariant(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        return importlib.util.spec_from_file_location(name, CORE) if name == "brushsvg._core" else None


if CORE.endswith(importlib.machinery.EXTENSION_SUFFIXES[0]):  # no other Python's
    sys.meta_path.insert(0, CoreOfVariant())
    if HIGHWAY_BIT:  # better targets have lower bits; without a shared libhwy the fingerprint does not change
        with contextlib.suppress(OSError):
            disable = ctypes.CDLL("libhwy.so.1")._ZN3hwy14DisableTargetsEl
            disable.argtypes, disable.restype = [ctypes.c_int64], None
            disable((1 << int(HIGHWAY_BIT)) - 1)
