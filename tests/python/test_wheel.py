"""The tools that make wheels: the files they add, and the wheels they refuse."""

import base64
import hashlib
import json
import re
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

import brushsvg._core

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tools" / "wheel"))

contents = pytest.importorskip("contents")
INFO = "brushsvg-0.1.0.dist-info"
FOUND = [
    contents.Component("Ceres", "2.1", "BSD-3-Clause", "Debian", "pkg:deb/debian/ceres@2.1", "ceres\n"),
    contents.Component("libc++", "21", "Apache-2.0 WITH LLVM-exception", "PyPI", "pkg:pypi/z@1", "llvm\n"),
]
METADATA = """Metadata-Version: 2.4
Name: brushsvg
License-Expression: MIT
License-File: LICENSE

# brushsvg

Text.
"""
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="wheels are made and read on Linux")


def a_library() -> bytes:
    """Return a small extension module of Python itself that needs only the C library."""
    for path in sorted(Path(sysconfig.get_config_var("DESTSHARED")).glob("*.so")):
        data = path.read_bytes()
        if len(data) < 100_000 and not list(contents.problems_of_library(data)):
            return data
    pytest.skip("this Python has no modules in files of their own")


@pytest.fixture
def raw(tmp_path):
    """Write a wheel as a build leaves it.

    Its files are in any order, with the time at which they were made.
    """
    path = tmp_path / "raw.whl"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr(f"{INFO}/RECORD", "old")
        file.writestr(f"{INFO}/METADATA", METADATA)
        file.writestr("brushsvg/_core.so", a_library())
        file.writestr("brushsvg/__init__.py", "")
        file.writestr(f"{INFO}/licenses/LICENSE", "MIT")
    return path


@pytest.fixture
def wheel(raw, tmp_path):
    contents.add_contents(raw, tmp_path / "brushsvg-0.1.0-cp311.whl", FOUND, 1_700_000_000)
    return tmp_path / "brushsvg-0.1.0-cp311.whl"


def changed(wheel: Path, **files: bytes | None) -> Path:
    """Return a copy with other files; None leaves a file out."""
    out = wheel.with_name("changed.whl")
    with zipfile.ZipFile(wheel) as file, zipfile.ZipFile(out, "w") as other:
        for name in file.namelist():
            if files.get(name, b"") is not None:
                other.writestr(name, files.pop(name, None) or file.read(name))
        for name, data in files.items():
            if data is not None:
                other.writestr(name, data)
    return out


def test_a_wheel_has_licences_and_a_bill_of_materials(wheel):
    assert contents.problems_of(wheel) == []
    with zipfile.ZipFile(wheel) as file:
        bill = json.loads(file.read(f"{INFO}/{contents.BILL}"))
        metadata = file.read(f"{INFO}/METADATA").decode()
        texts = {each.name: file.read(f"{INFO}/licenses/third-party/{each.name.lower()}.txt") for each in FOUND}
        record = file.read(f"{INFO}/RECORD").decode().splitlines()
        hashes = {name: base64.urlsafe_b64encode(hashlib.sha256(file.read(name)).digest()) for name in file.namelist()}
    assert bill["bomFormat"] == "CycloneDX" and bill["metadata"]["component"]["version"] == "0.1.0"
    assert [each["name"] for each in bill["components"]] == ["Ceres", "libc++"]
    assert texts == {"Ceres": b"ceres\n", "libc++": b"llvm\n"}
    head, _, body = metadata.partition("\n\n")
    assert "License-Expression: MIT AND Apache-2.0 WITH LLVM-exception AND BSD-3-Clause" in head
    assert re.findall(r"License-File: (.*)", head) == [
        "LICENSE",
        "third-party/ceres.txt",
        "third-party/libc++.txt",
    ]
    assert body == "# brushsvg\n\nText.\n"
    for line in record[:-1]:
        name, digest, _ = line.split(",")
        assert digest == f"sha256={hashes[name].decode().rstrip('=')}"
    assert record[-1] == f"{INFO}/RECORD,," and len(record) == len(hashes)


def test_the_same_files_give_the_same_bytes_in_any_order_and_at_any_time(raw, wheel, tmp_path):
    with zipfile.ZipFile(raw) as file, zipfile.ZipFile(tmp_path / "again.whl", "w") as again:
        for name in reversed(file.namelist()):
            again.writestr(zipfile.ZipInfo(name, (2001, 2, 3, 4, 5, 6)), file.read(name))
    contents.add_contents(tmp_path / "again.whl", tmp_path / "out.whl", FOUND, 1_700_000_000)
    assert (tmp_path / "out.whl").read_bytes() == wheel.read_bytes()


@pytest.mark.parametrize("name", ["libcholmod-1a2b.so.3", "libspqr.so.2", "libumfpack-5.so", "libmetis.so.5"])
def test_a_library_under_the_gpl_is_refused(wheel, name):
    problems = contents.problems_of(changed(wheel, **{f"brushsvg.libs/{name}": a_library()}))
    assert len(problems) == 1 and name in problems[0]


@pytest.mark.parametrize(
    "word", [b"\0cholmod_l_start\0", b"\0libspqr.so.2\0", b"METIS_NodeND(", b"\0umfpack_di_solve\0"]
)
def test_code_of_a_library_under_the_gpl_is_refused(word):
    assert list(contents.problems_of_library(a_library() + word))


def test_a_module_of_a_developer_build_is_refused(wheel):
    """A developer's own build is refused.

    The module is linked to Debian's Ceres, which needs SuiteSparse and LAPACK.
    """
    data = Path(brushsvg._core.__file__).read_bytes()
    if b"libcholmod" not in data:
        pytest.skip("this module was compiled without SuiteSparse")
    problems = "\n".join(contents.problems_of(changed(wheel, **{"brushsvg/_core.so": data})))
    assert all(word in problems for word in ("cholmod", "cxsparse", "lapack"))


def test_a_missing_file_or_oversized_wheel_is_refused(wheel, monkeypatch):
    (problem,) = contents.problems_of(changed(wheel, **{f"{INFO}/{contents.BILL}": None}))
    assert contents.BILL in problem
    (problem,) = contents.problems_of(changed(wheel, **{f"{INFO}/licenses/third-party/ceres.txt": None}))
    assert "Ceres" in problem
    monkeypatch.setattr(contents, "LARGEST_BYTES", 1000)
    (problem,) = contents.problems_of(wheel)
    assert "1000" in problem


def test_a_path_of_the_build_machine_is_refused():
    assert not list(contents.problems_of_library(a_library()))
    assert list(contents.problems_of_library(a_library() + b"/home/somebody/brushsvg/cpp/values/plan.cpp\0"))


def test_the_page_lists_the_bundled_libraries(wheel):
    text = contents.page(wheel, "some.whl is\nconsistent")
    for each in FOUND:
        assert f"| {each.name} | {each.version} | {each.licence} | `{each.purl}` |" in text
    assert "some.whl is consistent" in text and '"bomFormat": "CycloneDX"' in text
