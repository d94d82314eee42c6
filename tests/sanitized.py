"""Runs Python tests with the core of a sanitizer's build: sanitized.py PRESET [PYTEST ARGUMENT ...]

The editable install of .venv would bring its own core back, also in the processes that tests start. So the package is
copied next to the core into build/PRESET/site, and a virtual environment there borrows everything else from .venv.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

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
    python = made_environment(ROOT / "build" / preset)
    found = [
        subprocess.check_output(["g++", f"-print-file-name={each}"], text=True).strip()
        for each in RUNTIME[preset]
    ]
    env = {**os.environ, **OPTIONS, "LD_PRELOAD": " ".join(found)}
    return subprocess.run(
        [python, "-m", "pytest", "-p", "no:cacheprovider", *words], cwd=ROOT, env=env
    ).returncode


def made_environment(build: Path) -> Path:
    """The Python of an environment whose brushsvg is the sources' with the build's core."""
    own = ROOT / ".venv" / "bin" / "python"
    code = "import sys; print(*(path for path in sys.path if 'site-packages' in path), sep='\\n')"
    borrowed = subprocess.check_output([own, "-c", code], text=True).split("\n")[:-1]
    package = build / "site" / "brushsvg"
    shutil.rmtree(build / "site", ignore_errors=True)
    shutil.copytree(
        ROOT / "python" / "brushsvg", package, ignore=shutil.ignore_patterns("__pycache__", "*.so")
    )
    for core in build.glob("_core*.so"):
        shutil.copy(core, package)
    venv = build / "venv"
    if not venv.exists():
        subprocess.run([own, "-m", "venv", "--without-pip", venv], check=True)
    (site,) = venv.glob("lib/python3.*/site-packages")
    # lines of paths: what stands in the .pth files there, such as the editable install, is not read
    (site / "sanitized.pth").write_text("\n".join([str(build / "site"), *borrowed, ""]), encoding="utf-8")
    command = venv / "bin" / "brushsvg"
    code = 'import sys\nfrom brushsvg.cli import main\nif __name__ == "__main__":\n    sys.exit(main())\n'
    command.write_text(f"#!{venv}/bin/python\n{code}")
    command.chmod(0o755)
    return venv / "bin" / "python"


if __name__ == "__main__":
    sys.exit(main(sys.argv))
