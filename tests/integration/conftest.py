"""Drawings for the installed command, and its results."""

import json
import shutil
from pathlib import Path

import pytest
from command import COMMAND, SOUND, brushsvg
from drawings import SOURCES, Inkscape, enlarged_kanji, kanji_file
from npm import UnavailableError, fetched
from plugin import Plugin

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session", autouse=True)
def _installed():
    assert COMMAND.exists(), f"{COMMAND} is missing: run make setup"
    needed = (
        ("rs274", "linuxcnc-uspace"),
        ("inkscape", "inkscape"),
        ("chromium", "chromium"),
        ("tesseract", "tesseract-ocr"),
    )
    for tool, package in needed:
        assert shutil.which(tool), f"{tool} is missing: apt-get install --no-install-recommends {package}"


@pytest.fixture(scope="session")
def npm(request):
    """Return a function: a name, packages with versions -> their folder node_modules.

    Skip the test if the packages are missing.
    """

    def get(name: str, packages: dict[str, str]) -> Path:
        try:
            return fetched(request.config.cache.mkdir(name), packages)
        except UnavailableError as reason:
            pytest.skip(f"{name}: {reason}")

    return get


@pytest.fixture(scope="session")
def inkscape(tmp_path_factory):
    return Inkscape(tmp_path_factory.mktemp("inkscape"))


@pytest.fixture(scope="module")
def plugin(tmp_path_factory):
    """Return the extension in a new profile of Inkscape, one per file of tests."""
    return Plugin(tmp_path_factory.mktemp("plugin"))


@pytest.fixture(scope="session")
def drawing(tmp_path_factory, inkscape):
    """Return a function: name of a source -> its SVG file, made on first request."""
    folder = tmp_path_factory.mktemp("drawings")
    make = {
        "vincent": lambda _: ROOT / "examples" / "vincent.svg",
        "robot": lambda _: ROOT / "examples" / "robot.svg",
        "kanji-eternity": lambda out: Path(shutil.copy(kanji_file("\u6c38"), out)),
        "kanji-write": lambda out: enlarged_kanji("\u66f8", out),
        "inkscape": lambda out: inkscape.save(out, plain=False),
        "inkscape-plain": lambda out: inkscape.save(out, plain=True),
    }
    known: dict[str, Path] = {}

    def get(name: str) -> Path:
        if name not in known:
            known[name] = make[name](folder / f"{name}.svg")
        return known[name]

    return get


@pytest.fixture(scope="session")
def converted(tmp_path_factory, drawing):
    """Return a function: source, flags -> folder with plan.json and program.ngc."""
    known: dict[tuple, Path] = {}

    def get(name: str, *flags: str) -> Path:
        key = (name, *flags)
        if key not in known:
            folder = known[key] = tmp_path_factory.mktemp(name)
            for out in ("plan.json", "program.ngc"):
                brushsvg("convert", drawing(name), "-o", out, *flags, cwd=folder, status=0)
        return known[key]

    return get


@pytest.fixture(scope="session")
def reported(tmp_path_factory, drawing):
    """Return a function: source, flags -> the output of report --json."""
    folder = tmp_path_factory.mktemp("reports")
    known: dict[tuple, dict] = {}

    def get(name: str, *flags: str) -> dict:
        if (name, *flags) not in known:
            done = brushsvg("preview", drawing(name), "--json", *flags, cwd=folder, status=0)
            known[name, *flags] = json.loads(done.out)
        return known[name, *flags]

    return get


@pytest.fixture(params=SOURCES)
def source(request) -> str:
    return request.param


@pytest.fixture
def desk(tmp_path):
    """Return a folder with a sound drawing and an older program."""
    (tmp_path / "sound.svg").write_text(SOUND)
    (tmp_path / "old.ngc").write_text("kept\n")
    return tmp_path
