"""A copy of what C++ is built of, whose sentences have other words: python reword_cpp.py FOLDER."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

from rewording import is_sentence, reworded

ROOT = Path(__file__).resolve().parents[2]
BUILT = (
    "CMakeLists.txt",
    "cmake",
    "cpp",
    "examples",
    "benchmarks",
    "tests/cpp",
    "tests/consumer",
    "tests/golden",
)
DATA = ("python/brushsvg/data",)
TEXT = re.compile(r'(?<![\w\'\\])"((?:[^"\\\n]|\\.)*)"')
# a line of a program, which is a format; what identifies JSON that another library read
KEPT = re.compile(r"comment\(|#\s*include|doc = ")


def in_other_words(source: str) -> str:
    def other(found: re.Match) -> str:
        return f'"{reworded(found[1])}"' if is_sentence(found[1]) else found[0]

    lines = source.split("\n")
    return "\n".join(line if KEPT.search(line) else TEXT.sub(other, line) for line in lines)


def main(folder: Path) -> None:
    listed = subprocess.run(["git", "ls-files", *BUILT, *DATA], cwd=ROOT, capture_output=True, text=True, check=True)
    for name in listed.stdout.splitlines():
        source, copy = ROOT / name, folder / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        if source.suffix in (".cpp", ".hpp") and name.startswith("cpp/"):
            text = in_other_words(source.read_text(encoding="utf-8"))
            if not copy.exists() or copy.read_text(encoding="utf-8") != text:  # or all is built anew
                copy.write_text(text, encoding="utf-8")
        elif not copy.exists() or copy.read_bytes() != source.read_bytes():
            shutil.copy(source, copy)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
