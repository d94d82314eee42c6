"""Print a fingerprint of the arithmetic of this process as JSON.

The fingerprint has an entry for each part that a variant may change.
"""

import ctypes
import hashlib
import json
import math

import numpy as np
import scipy.linalg  # loads its own OpenBLAS
from numpy._core import _multiarray_umath as features

import brushsvg
from brushsvg import _core


def digest(*parts) -> str:
    return hashlib.sha256(b"".join(np.asarray(part, float).tobytes() for part in parts)).hexdigest()[:12]


def loaded(name: str) -> list[str]:
    with open("/proc/self/maps") as maps:
        return sorted({line.split()[-1] for line in maps if name in line})


def blas_kernels() -> list[str]:
    found = []
    for path in loaded("openblas"):
        library = ctypes.CDLL(path)
        for prefix in ("scipy_", ""):
            for suffix in ("64_", ""):
                name = getattr(library, f"{prefix}openblas_get_corename{suffix}", None)
                if name is not None:
                    name.restype = ctypes.c_char_p
                    found.append(name().decode())
    return sorted(set(found))


def painted() -> str:
    brush = brushsvg.find_brush("round-6")
    bend = np.array([[10, 10, 30, 55, 50, -20, 70, 30]], float)
    stroke = brushsvg.Stroke("s", bend, half_width=[(0, 1.5), (1, 2.5)])
    plan = brushsvg.compensate([stroke], brush, (80, 60)).plan
    marks = brushsvg.simulate(plan, brush)
    brushsvg.trace_outlines(marks, brush)
    return digest(plan.passes[0].poses_mm, *marks.passes[0].outline_mm)


x = np.arange(1, 20000) * 5e-4
square = np.random.default_rng(1).normal(size=(120, 120))
print(
    json.dumps(
        {
            "core_file": _core.__file__,
            "core": painted(),
            "glibc": digest(*[[f(v) for v in x] for f in (math.exp, math.sin, math.log, math.atan)]),
            "numpy": sorted(name for name in features.__cpu_dispatch__ if features.__cpu_features__[name]),
            "numpy_results": digest(np.exp(x), np.sin(x), x**1.7, np.add.reduce(x)),
            "blas": blas_kernels(),
            "blas_results": digest(square @ square, scipy.linalg.inv(square)),
        }
    )
)
