"""Plant the faults in a copy of the tree, each with a switch, and build the copy."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import cpp_faults
import python_faults
from fault import BUILD, EXAMPLES, Choice, Fault, planted, shares
from safety import part_of

SWITCHES = Path(__file__).parent / "switches"
PACKAGE = "python/brushsvg"
TARGETS = ("_core", "brushsvg_tests", *(f"example_{name}" for name in EXAMPLES))


def plant(root: Path, work: Path, seed: int, python: int, cpp: int, safety: int = 0) -> list[Fault]:
    """Copy the tree at root to work/tree, plant faults and build it.

    The counts of faults are for each language. safety is the count for each part of the safety code instead.
    """
    tree = work / "tree"
    copy_tree(root, tree)
    make_venv(root, tree)
    sources = read_sources(tree)
    faults = choose_python(tree, seed, python, safety)
    if not cpp and not safety:  # nothing to build
        number_all(faults)
        write(tree, sources, faults)
        code = "import brushsvg._core; print(brushsvg._core.__file__)"
        done = subprocess.run([root / ".venv/bin/python", "-c", code], capture_output=True, text=True, check=True)
        shutil.copy(done.stdout.strip(), tree / PACKAGE)
        return save(work, faults)
    choice = choose_cpp(tree, seed, cpp, safety)
    while True:
        number_all([*faults, *choice.chosen])
        write(tree, sources, [*faults, *choice.chosen])
        refused = build(tree, choice.chosen)
        if not refused:
            break
        for fault in refused:  # a fault in a header may compile in one file and not in another
            print(f"does not compile: {fault.file}:{fault.line}: {fault.change}")
            choice.give_back(fault)
            choice.take(fault.place)
    return save(work, faults + choice.chosen)


def number_all(faults: list[Fault]) -> None:
    for number, fault in enumerate(faults, 1):
        fault.number = number


def save(work: Path, faults: list[Fault]) -> list[Fault]:
    """Save the faults, and delete the results of earlier faults."""
    for name in ("map", "tried"):
        shutil.rmtree(work / name, ignore_errors=True)
    (work / "tiers.json").unlink(missing_ok=True)
    (work / "faults.json").write_text(json.dumps([asdict(fault) for fault in faults], indent=1), encoding="utf-8")
    return faults


def copy_tree(root: Path, tree: Path) -> None:
    """Copy all files that git knows or would add.

    Files that no longer exist are deleted. Built files stay.
    """
    words = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(words, cwd=root, capture_output=True, check=True)
    files = {name for name in listed.stdout.decode().split("\0") if name and (root / name).is_file()}
    for name in files:
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        update(tree / name, (root / name).read_bytes())
        shutil.copymode(root / name, tree / name)
    for folder in ("python", "cpp", "tests"):
        for path in (tree / folder).rglob("*"):
            known = path.relative_to(tree).as_posix() in files or path.suffix in (".so", ".pyc")
            if path.is_file() and not known:
                path.unlink()


def update(path: Path, content: bytes) -> None:
    """Write a file only if its content changes, so that it is not compiled again."""
    if not path.exists() or path.read_bytes() != content:
        path.write_bytes(content)


def make_venv(root: Path, tree: Path) -> None:
    """Make a .venv with the planted package and the switches.

    All other packages come from the tree's own .venv.
    """
    python = root / ".venv/bin/python"
    code = "import sys; print(sys.version_info[1], *(path for path in sys.path if 'site-packages' in path), sep='\\n')"
    done = subprocess.run([python, "-c", code], capture_output=True, text=True, check=True)
    minor, *paths = done.stdout.split("\n")[:-1]
    venv = tree / ".venv"
    if not (venv / "bin/python").exists():
        subprocess.run([python, "-m", "venv", "--without-pip", venv], check=True)
    site = venv / f"lib/python3.{minor}/site-packages"
    for name in ("brushsvg_faults.py", "brushsvg_faults_pytest.py"):
        shutil.copy(SWITCHES / name, site)
    (site / "faults.pth").write_text("\n".join([str(tree / "python"), *paths, "import brushsvg_faults", ""]))
    for script in (root / ".venv/bin").iterdir():
        if not (venv / "bin" / script.name).exists():
            (venv / "bin" / script.name).symlink_to(script)
    command = venv / "bin/brushsvg"
    command.unlink()
    code = 'import sys\nfrom brushsvg.cli import main\nif __name__ == "__main__":\n    sys.exit(main())\n'
    command.write_text(f"#!{venv}/bin/python\n{code}")
    command.chmod(0o755)


def choose_python(tree: Path, seed: int, count: int, safety: int) -> list[Fault]:
    sources = {path: path.read_bytes() for path in sorted((tree / PACKAGE).rglob("*.py"))}
    words = {path: python_faults.names_in(source) for path, source in sources.items()}
    candidates = []
    for path, source in sources.items():
        elsewhere = set().union(*(names for other, names in words.items() if other != path))
        candidates += python_faults.candidates(path.relative_to(tree).as_posix(), source, elsewhere)

    def accept(fault: Fault) -> bool:
        fault.edits = fault.variants[0]
        try:
            compile(planted(sources[tree / fault.file], [fault]), fault.file, "exec", dont_inherit=True)
        except SyntaxError:
            return False
        return True

    choice = Choice(in_parts(candidates) if safety else candidates, seed, accept)
    if safety:
        return take_each(choice, safety)
    return take_all(choice, count, {path.relative_to(tree).as_posix(): text for path, text in sources.items()})


def choose_cpp(tree: Path, seed: int, count: int, safety: int) -> Choice:
    configure(tree)
    compiler = Compiler(tree)
    sources = {
        path.relative_to(tree).as_posix(): path.read_bytes()
        for path in sorted((tree / "cpp").rglob("*.[ch]pp"))
        if compiler.command(path.relative_to(tree).as_posix())
    }
    candidates = [fault for file, source in sources.items() for fault in cpp_faults.candidates(file, source)]
    chosen_from = in_parts(candidates) if safety else candidates
    choice = Choice(chosen_from, seed, lambda fault: compiler.accepts(fault, sources[fault.file]))
    if safety:
        take_each(choice, safety)
    else:
        take_all(choice, count, sources)
    return choice


def in_parts(candidates: list[Fault]) -> list[Fault]:
    """Return the faults in the safety code, with their parts."""
    for fault in candidates:
        fault.part = part_of(fault) or ""
    return [fault for fault in candidates if fault.part]


def take_each(choice: Choice, count: int) -> list[Fault]:
    for part in choice.folders:
        for _ in range(count):
            if (fault := choice.take(part)) is None:
                print(f"{part} has no more faults")
                break
            print(f"chosen: {fault.file}:{fault.line}: {fault.kind}", flush=True)
    return sorted(choice.chosen, key=lambda fault: (fault.file, fault.line))


def take_all(choice: Choice, count: int, sources: dict[str, bytes]) -> list[Fault]:
    sizes = {folder: 0 for folder in choice.folders}
    for file, source in sources.items():
        folder = file.rpartition("/")[0]
        if folder in sizes:
            sizes[folder] += source.count(b"\n")
    counts = shares(count, sizes)
    for folder in sorted(sizes, key=sizes.get):  # small folders first, since they have the fewest kinds
        for _ in range(counts[folder]):
            if (fault := choice.take(folder)) is None:
                print(f"{folder} has no more faults")
            else:
                print(f"chosen: {fault.file}:{fault.line}: {fault.kind}", flush=True)
    return sorted(choice.chosen, key=lambda fault: (fault.file, fault.line))


def configure(tree: Path) -> None:
    python = tree / ".venv/bin/python"
    done = subprocess.run([python, "-m", "pybind11", "--cmakedir"], capture_output=True, text=True, check=True)
    words = [
        f"-Dpybind11_DIR={done.stdout.strip()}",
        f"-DPython_EXECUTABLE={python}",
        "-DCMAKE_BUILD_TYPE=Release",
    ]
    words += [f"-DBRUSHSVG_{part}=ON" for part in ("PYTHON", "TESTS", "FIT")]
    if ccache := shutil.which("ccache"):
        words.append(f"-DCMAKE_CXX_COMPILER_LAUNCHER={ccache}")
    words += ["-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", "-G", "Ninja"]
    subprocess.run(["cmake", "-S", tree, "-B", tree / BUILD, *words], stdout=subprocess.DEVNULL, check=True)


class Compiler:
    """Test whether faults compile, in headers by a file that includes them."""

    def __init__(self, tree: Path):
        self.tree = tree
        listed = json.loads((tree / BUILD / "compile_commands.json").read_text(encoding="utf-8"))
        self.commands = {}
        for each in listed:
            path = Path(each["file"])
            if path.is_relative_to(tree / "cpp"):
                self.commands[path.relative_to(tree).as_posix()] = shlex.split(each["command"])
        self.includes = {
            path: set(re.findall(r'#include "(?:[\w/]*/)?(\w+\.hpp)"', (tree / path).read_text(encoding="utf-8")))
            for path in [each.relative_to(tree).as_posix() for each in (tree / "cpp").rglob("*.[ch]pp")]
        }

    def command(self, file: str) -> list[str] | None:
        """Return the command that compiles the file.

        For a header, it is the command of the first source that includes it directly or indirectly.
        """
        seen, names = set(), {file}
        while names - seen:
            seen |= names
            if found := sorted(names & set(self.commands)):
                return self.commands[found[0]]
            stems = {name.rpartition("/")[2] for name in names}
            names = names | {path for path, included in self.includes.items() if included & stems}
        return None

    def accepts(self, fault: Fault, source: bytes) -> bool:
        path = self.tree / fault.file
        words = [word for word in self.command(fault.file) if not word.endswith(("ccache", "cmake_pch.hxx"))]
        words = [*words[: words.index("-o")], "-fsyntax-only", words[-1]]
        words = [word for word in words if word not in ("-include", "-Winvalid-pch")]
        before = path.read_bytes()
        try:
            for variant in fault.variants:
                fault.edits = variant
                path.write_bytes(with_switches(source, [fault], self.tree))
                if subprocess.run(words, cwd=self.tree / BUILD, capture_output=True).returncode == 0:
                    return True
        finally:
            path.write_bytes(before)
        return False


def with_switches(source: bytes, faults: list[Fault], tree: Path) -> bytes:
    text = planted(source, faults)
    if faults and not faults[0].file.endswith(".py"):
        header = tree / "brushsvg_faults.hpp"
        shutil.copy(SWITCHES / header.name, header)
        text = (
            f'#include "{header}"\n#line 1\n'.encode() + text
        )  # with #line, errors show the lines of the original file
    return text


def read_sources(tree: Path) -> dict[str, bytes]:
    paths = [path for folder in (PACKAGE, "cpp") for path in sorted((tree / folder).rglob("*"))]
    return {
        path.relative_to(tree).as_posix(): path.read_bytes() for path in paths if path.suffix in (".py", ".cpp", ".hpp")
    }


def write(tree: Path, sources: dict[str, bytes], faults: list[Fault]) -> None:
    by_file: dict[str, list[Fault]] = {}
    for fault in faults:
        by_file.setdefault(fault.file, []).append(fault)
    for file, source in sources.items():
        update(tree / file, with_switches(source, by_file.get(file, []), tree))


def build(tree: Path, faults: list[Fault]) -> list[Fault]:
    """Build the tree; return the faults that the compiler refuses."""
    jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count()))
    words = ["cmake", "--build", tree / BUILD, "-j", jobs, "--target", *TARGETS, "--", "-k", "0"]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode == 0:
        for path in (tree / BUILD).glob("_core*.so"):
            shutil.copy(path, tree / PACKAGE)
        return []
    refused = []
    for path, line in set(re.findall(r"^(\S+?):(\d+):\d+: (?:fatal )?error", done.stdout, re.M)):
        inside = [fault for fault in faults if path.endswith(fault.file)]
        if inside:
            nearest = min(inside, key=lambda fault: abs(fault.line - int(line)))
            if nearest not in refused:
                refused.append(nearest)
    if not refused:
        sys.exit(done.stdout[-4000:] + done.stderr)
    return refused
