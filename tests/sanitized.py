"""Runs Python tests with the core of a sanitizer's build: sanitized.py PRESET [PYTEST ARGUMENT ...]

In an environment of their own, build/PRESET/environment.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from copied_package import made_environment

ROOT = Path(__file__).resolve().parents[1]
RUNTIME = {"asan": ("libasan.so", "libubsan.so"), "tsan": ("libtsan.so",)}
# Python and its libraries free nothing at exit, and are not compiled for the thread sanitizer: only what happens in
# code that is can be judged.
OPTIONS = {
    "ASAN_OPTIONS": "detect_leaks=0:exitcode=99",
    "UBSAN_OPTIONS": "print_stacktrace=1",
    "TSAN_OPTIONS": "ignore_noninstrumented_modules=1:exitcode=99",
}


def main(argv: list[str]) -> int:
    preset, *words = argv[1:]
    (core,) = (ROOT / "build" / preset).glob("_core*.so")
    python = made_environment(ROOT / "build" / preset / "environment", core)
    found = [
        subprocess.check_output(["g++", f"-print-file-name={each}"], text=True).strip() for each in RUNTIME[preset]
    ]
    env = {**os.environ, **OPTIONS, "LD_PRELOAD": " ".join(found)}
    return subprocess.run([python, "-m", "pytest", "-p", "no:cacheprovider", *words], cwd=ROOT, env=env).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv))
