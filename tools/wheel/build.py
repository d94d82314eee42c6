"""Build the wheels for x86-64 Linux: build.py --python PROGRAM [--python PROGRAM ...] [--out FOLDER]

Needs the packages of `make system`. zig compiles everything against the C library of manylinux_2_28. Ceres
comes from Debian's source package (libraries.sh). Times, paths and order of files do not depend on the
machine.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

from contents import add_contents, components, problems_of

PLATFORM = "manylinux_2_28_x86_64"
TOOLS = Path(__file__).resolve().parent
TREE = TOOLS.parents[1]
WORK = TREE / "build" / "wheel"


def main() -> None:
    """Build a wheel for each Python, then print its name, size and hash."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--python", action="append", help="an interpreter with headers; default: this one")
    parser.add_argument("--out", type=Path, default=TREE / "dist")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    for python in args.python or [sys.executable]:
        wheel = build(python, args.out.resolve())
        problems = problems_of(wheel)
        if problems:
            wheel.unlink()
            sys.exit("\n".join(problems))
        digest = hashlib.sha256(wheel.read_bytes()).hexdigest()
        print(f"{wheel}: {wheel.stat().st_size / 1e6:.2f} MB, sha256 {digest}", flush=True)


def build(python: str, out: Path) -> Path:
    """Compile and check one wheel."""
    name = _output(python, "-c", "import sys; print('cp%d%d' % sys.version_info[:2])").strip()
    folder = WORK / name
    tools = folder / "venv"
    if not tools.is_dir():
        _run(python, "-m", "venv", tools)
        _run(tools / "bin" / "pip", "install", "-q", "-r", TOOLS / "requirements.txt")
    zig = _output(tools / "bin" / "python", "-c", "import ziglang; print(ziglang.__path__[0])").strip() + "/zig"
    environment = {
        **os.environ,
        "ZIG": zig,
        "ZIG_GLOBAL_CACHE_DIR": str(WORK / "zig-cache"),
        "SOURCE_DATE_EPOCH": _output("git", "-C", TREE, "log", "-1", "--format=%ct").strip(),
        # Otherwise ccache shortens paths before -ffile-prefix-map does, and they stay in the library.
        "CCACHE_BASEDIR": "",
        # Otherwise a file compiled by one zig would be reused for another zig.
        "CCACHE_COMPILERTYPE": "clang",
        "CCACHE_COMPILERCHECK": f"string:{_output(zig, 'version')}{(TOOLS / 'zig-c++').read_text()}",
        "PYTHONDONTWRITEBYTECODE": "1",
        "LC_ALL": "C.UTF-8",
        "PATH": f"{tools / 'bin'}:{os.environ['PATH']}",
    }
    _run(TOOLS / "libraries.sh", WORK, env=environment)
    _python_headers(tools / "bin" / "python")
    for made in ("raw", "repaired"):
        shutil.rmtree(folder / made, ignore_errors=True)
    _run(
        *(
            tools / "bin" / "pip",
            "wheel",
            "-q",
            "--no-build-isolation",
            "--no-deps",
            "--wheel-dir",
            folder / "raw",
        ),
        *(word for define in _definitions() for word in ("--config-settings", f"cmake.define.{define}")),
        *("--config-settings", f"build-dir={folder / 'out'}"),
        _clean_copy(folder / "source"),
        env=environment,
    )
    (raw,) = (folder / "raw").glob("*.whl")
    audit = (tools / "bin" / "auditwheel", "repair", "--plat", PLATFORM, "--only-plat")
    _run(*audit, "--wheel-dir", folder / "repaired", raw, env=environment)
    (repaired,) = (folder / "repaired").glob("*.whl")
    report = _output(tools / "bin" / "auditwheel", "show", repaired, env=environment)
    wheel = out / repaired.name
    add_contents(repaired, wheel, components(WORK, tools), int(environment["SOURCE_DATE_EPOCH"]))
    (folder / "auditwheel.txt").write_text(report)
    return wheel


def _definitions() -> list[str]:
    """Return the definitions that make CMake use only our compiler and our libraries."""
    prefix = WORK / "prefix"
    flags = [
        *("-isystem", prefix / "include", "-DEIGEN_MPL2_ONLY", "-DMAX_LOG_LEVEL=-3"),
        # Boost 1.74 needs std::unary_function, and enum values that have no name.
        *("-D_LIBCPP_ENABLE_CXX17_REMOVED_UNARY_BINARY_FUNCTION", "-Wno-enum-constexpr-conversion"),
        *(f"-ffile-prefix-map={folder}=." for folder in (WORK, TREE)),
    ]
    return [
        "CMAKE_BUILD_TYPE=Release",
        f"CMAKE_C_COMPILER={TOOLS / 'zig-cc'}",
        f"CMAKE_CXX_COMPILER={TOOLS / 'zig-c++'}",
        "CMAKE_CXX_FLAGS=" + " ".join(map(str, flags)),
        f"Ceres_DIR={prefix}/lib/cmake/Ceres",
        f"nlohmann_json_DIR={prefix}/lib/cmake/nlohmann_json",
        f"Boost_INCLUDE_DIR={prefix}/include",
        "Boost_NO_BOOST_CMAKE=ON",
        "Eigen3_DIR=/usr/share/eigen3/cmake",
    ]


def _python_headers(python: Path) -> None:
    """Link the Python header that Debian keeps next to the headers of its C library.

    The link makes it visible without the headers of the C library.
    """
    where = "import sysconfig as s; print(s.get_path('include'), s.get_config_var('MULTIARCH') or '')"
    include, _, multiarch = _output(python, "-c", where).strip().partition(" ")
    name = Path(include).name
    there, here = Path("/usr/include") / multiarch / name, WORK / "prefix" / "include" / multiarch / name
    if include == f"/usr/include/{name}" and there.is_dir() and not here.exists():
        here.parent.mkdir(parents=True, exist_ok=True)
        here.symlink_to(there)


def _clean_copy(to: Path) -> Path:
    """Copy the checked-out revision and its changes, without other files in the tree."""
    shutil.rmtree(to, ignore_errors=True)
    for name in _output("git", "-C", TREE, "ls-files", "-z", "--cached", "--others", "--exclude-standard").split("\0"):
        if name and (TREE / name).is_file():
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(TREE / name, to / name)
    return to


def _run(*words, env=None) -> None:
    subprocess.run(list(map(str, words)), check=True, env=env)


def _output(*words, env=None) -> str:
    return subprocess.run(list(map(str, words)), check=True, env=env, stdout=subprocess.PIPE, text=True).stdout


if __name__ == "__main__":
    main()
