"""Other people's material from npm, fetched once and kept in pytest's cache."""

import fcntl
import json
import shutil
import subprocess
from pathlib import Path

LIMIT_S = 600


class UnavailableError(Exception):
    """The packages are not available; the text gives the reason."""


def fetched(folder: Path, packages: dict[str, str]) -> Path:
    """Return the folder node_modules with these packages (name -> version).

    Existing packages are not fetched again. Raise UnavailableError without node and npm, or if npm cannot
    fetch the packages.
    """
    modules = folder / "node_modules"
    for tool in ("node", "npm"):
        if not shutil.which(tool):
            raise UnavailableError(f"{tool} is missing: apt-get install --no-install-recommends nodejs npm")
    with (folder / "lock").open("w") as lock:  # tests run in parallel
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not all(_has(modules, *each) for each in packages.items()):
            _install(folder, packages)
    return modules


def _install(folder: Path, packages: dict[str, str]) -> None:
    options = ("--no-package-lock", "--no-save", "--no-audit", "--no-fund", "--ignore-scripts")
    # Name all packages, because npm removes the others.
    target = [f"{name}@{version}" for name, version in packages.items()]
    words = ["npm", "install", "--prefix", str(folder), *options, *target]
    try:
        done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        raise UnavailableError(f"npm did not fetch {' '.join(packages)} within {LIMIT_S} s") from None
    if done.returncode or not all(_has(folder / "node_modules", *each) for each in packages.items()):
        raise UnavailableError(f"npm could not fetch {' '.join(packages)}: {done.stderr[-200:]}")


def _has(modules: Path, name: str, version: str) -> bool:
    about = modules / name / "package.json"
    return about.exists() and json.loads(about.read_text(encoding="utf-8"))["version"] == version
