"""Write the stubs of the C++ module for editors and type checkers.

    python tools/make_stubs.py [FOLDER]

pybind11-stubgen derives them from the built module. This script adds the types that pybind11 cannot express.
A test compares the files in the tree with the files that this script makes.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "python" / "brushsvg"

# Signatures of pybind11 do not show that a name can stand for a StrokeId, and that any value can be compared.
# They also do not show that a number gives a number and an array gives an array.
REPLACEMENTS = (
    (r"def __eq__\(self, arg0: \w+\) -> bool", "def __eq__(self, other: object, /) -> bool"),
    (r"\b(id|stroke): StrokeId = ''", r"\1: StrokeId | str = ''"),
    (r"(def (?:id|stroke)\(self, arg1): StrokeId\)", r"\1: StrokeId | str)"),
    (r"progress: typing\.Any = None", "progress: collections.abc.Callable[[int, int], object] | None = None"),
    (r"def warnings\(self\) -> tuple:", "def warnings(self) -> tuple[Notice, ...]:"),
    (r"def remarks\(brush: Brush\) -> list:", "def remarks(brush: Brush) -> list[Notice]:"),
    (r"\*\*kwargs\)", "**fields: object)"),
    (
        r"def (depth_range_mm|calibrated_mm|sheet_mm)\(self\) -> tuple\[float, \.\.\.\]",
        r"def \1(self) -> tuple[float, float]",
    ),
    (r"typing\.SupportsFloat \| typing\.SupportsIndex", "float"),
    (r"typing\.SupportsInt \| typing\.SupportsIndex", "int"),
    (r'typing\.Annotated\[([^"]*), "[^"]*"\]', r"\1"),
    (r"numpy\.typing\.ArrayLike, numpy\.float64", "numpy.typing.ArrayLike"),
    (r"typing\.Annotated\[numpy\.typing\.ArrayLike\]", "numpy.typing.ArrayLike"),
    (
        r"__hash__: typing\.ClassVar\[None\] = None",
        "__hash__: typing.ClassVar[None]  # type: ignore[assignment]",
    ),
    (
        r"( +)def (__call__|extrapolated)\(self, depth_mm: numpy\.typing\.ArrayLike\) -> typing\.Any:"
        r"\s+\"\"\"[^\"]*\"\"\"",
        r"\1@typing.overload\n"
        r"\1def \2(self, depth_mm: float) -> float: ...  # type: ignore[overload-overlap]\n"
        r"\1@typing.overload\n"
        r"\1def \2(self, depth_mm: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]: ...",
    ),
)
SHORTER = (
    (r" +def __(getstate|setstate|repr)__\(.*\n", ""),  # every class has them
    (r':(\n +""")\n +(.+)\n +"""', r':\1\2"""'),
)


def stub_files() -> dict[str, str]:
    """Return the text of each stub by its file name below the package."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["-m", "pybind11_stubgen", "brushsvg._core", "--output-dir", folder]
        enums = [f"--enum-class-locations={name}:brushsvg._core" for name in ("Norm", "Lines")]
        exact = ["--numpy-array-wrap-with-annotated", "--exit-code"]
        subprocess.run([sys.executable, *words, *enums, *exact], check=True, capture_output=True, text=True)
        made = {path.name: path.read_text() for path in sorted(Path(folder).rglob("*.pyi"))}
    for name, text in made.items():
        for said, replacement in REPLACEMENTS:
            text = re.sub(said, replacement, text)
        if "Notice" in text:
            text = text.replace("import typing\n", "import typing\nfrom ..errors import Notice\n", 1)
        format_it = [sys.executable, "-m", "ruff", "format", "--line-length=120", "--stdin-filename", name, "-"]
        done = subprocess.run(format_it, input=text, capture_output=True, text=True, check=True, cwd=PACKAGE)
        text = done.stdout
        for said, replacement in SHORTER:
            text = re.sub(said, replacement, text)
        made[name] = text
    return made


def main() -> None:
    """Write the files to the given folder, or to the folder in the package."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else PACKAGE / "_core"
    folder.mkdir(exist_ok=True)
    for name, text in stub_files().items():
        (folder / name).write_text(text)


if __name__ == "__main__":
    main()
