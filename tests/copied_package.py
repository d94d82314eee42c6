"""An environment whose brushsvg is a copy of the sources with a core of its own.

The editable install of .venv would bring its own core back, also in the processes that tests start, and Atheris does
not instrument what it imports.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def made_environment(folder: Path, core: Path) -> Path:
    """The Python of an environment in a folder; all but brushsvg is borrowed from .venv."""
    own = ROOT / ".venv" / "bin" / "python"
    code = "import sys; print(*(path for path in sys.path if 'site-packages' in path), sep='\\n')"
    borrowed = subprocess.check_output([own, "-c", code], text=True).split("\n")[:-1]
    package = folder / "site" / "brushsvg"
    shutil.rmtree(folder / "site", ignore_errors=True)
    shutil.copytree(ROOT / "python" / "brushsvg", package, ignore=shutil.ignore_patterns("__pycache__", "*.so"))
    shutil.copy(core, package)
    venv = folder / "venv"
    if not venv.exists():
        subprocess.run([own, "-m", "venv", "--without-pip", venv], check=True)
    (site,) = venv.glob("lib/python3.*/site-packages")
    # lines of paths: what stands in the .pth files there, such as the editable install, is not read
    (site / "copied.pth").write_text("\n".join([str(folder / "site"), *borrowed, ""]), encoding="utf-8")
    command = venv / "bin" / "brushsvg"
    code = 'import sys\nfrom brushsvg.cli import main\nif __name__ == "__main__":\n    sys.exit(main())\n'
    command.write_text(f"#!{venv}/bin/python\n{code}")
    command.chmod(0o755)
    return venv / "bin" / "python"
