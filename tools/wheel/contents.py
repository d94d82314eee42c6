"""Add licences and a bill of materials to a wheel; check and document a wheel.

contents.py check WHEEL
contents.py page WHEEL AUDITWHEEL_REPORT PAGE
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

LARGEST_BYTES = 6_000_000
BILL = "sboms/brushsvg.cdx.json"  # PEP 770
# Names of SuiteSparse and of the libraries that it needs. They are under the GPL, or linked only together
# with code under the GPL.
FORBIDDEN = (
    "cholmod",
    "spqr",
    "umfpack",
    "metis",
    "suitesparseconfig",
    "cxsparse",
    "lapack",
    "gfortran",
    "openblas",
)
SYSTEM_LIBRARIES = {
    "libc.so.6",
    "libm.so.6",
    "libpthread.so.0",
    "libdl.so.2",
    "librt.so.1",
    "ld-linux-x86-64.so.2",
}


@dataclass
class Component:
    """A library whose compiled code is in the wheel."""

    name: str
    version: str
    licence: str
    source: str
    purl: str
    text: str


def components(work: Path, tools: Path) -> list[Component]:
    """Return all libraries in the wheel, sorted.

    work: the folder of libraries.sh. tools: the venv of the compiler.
    """
    (zig,) = tools.glob("lib/python*/site-packages/ziglang")
    (pybind,) = tools.glob("lib/python*/site-packages/pybind11-*.dist-info")
    clang = subprocess.run([zig / "zig", "c++", "--version"], check=True, capture_output=True, text=True).stdout
    llvm = re.search(r"version (\S+)", clang)[1]
    found = [
        _debian_source("ceres-solver", "2.1.0+really2.1.0+dfsg-1", "BSD-3-Clause", work),
        _debian_headers("libeigen3-dev", "Eigen", "MPL-2.0", _copyright("libeigen3-dev")),
        _debian_headers(_boost_package(), "Boost", "BSL-1.0", _boost_licence()),
        _debian_headers("nlohmann-json3-dev", "nlohmann json", "MIT", _copyright("nlohmann-json3-dev")),
        Component(
            "pybind11",
            pybind.name.removeprefix("pybind11-").removesuffix(".dist-info"),
            "BSD-3-Clause",
            "PyPI",
            f"pkg:pypi/{pybind.name.removesuffix('.dist-info').replace('-', '@')}",
            (pybind / "licenses" / "LICENSE").read_text(),
        ),
    ]  # fmt: skip
    zig_version = subprocess.run([zig / "zig", "version"], check=True, capture_output=True, text=True).stdout.strip()
    purl = f"pkg:pypi/ziglang@{zig_version}"
    for name, folder in (("libc++", "libcxx"), ("libc++abi", "libcxxabi"), ("libunwind", "libunwind")):
        text = (zig / "lib" / folder / "LICENSE.TXT").read_text()
        found.append(Component(name, llvm, "Apache-2.0 WITH LLVM-exception", "PyPI's ziglang", purl, text))
    found.append(
        Component(
            "zig's compiler runtime",
            zig_version,
            "MIT",
            "PyPI's ziglang",
            purl,
            (zig / "LICENSE").read_text(),
        )
    )
    return sorted(found, key=lambda each: each.name.lower())


def _debian_source(name: str, version: str, licence: str, work: Path) -> Component:
    text = (work / "licences" / f"{name}.txt").read_text()
    return Component(
        name, version, licence, f"Debian's source package {name}", f"pkg:deb/debian/{name}@{version}", text
    )


def _debian_headers(package: str, name: str, licence: str, text: str) -> Component:
    command = ["dpkg-query", "-W", "-f", "${Version}", package]
    version = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return Component(name, version, licence, f"Debian's package {package}", f"pkg:deb/debian/{package}@{version}", text)


def _copyright(package: str) -> str:
    return (Path("/usr/share/doc") / package / "copyright").read_text()


def _boost_package() -> str:
    """Return the name of Debian's package of Boost, which contains the version.

    It is libboost1.74-dev on Debian 12 and libboost1.83-dev on Debian 13.
    """
    command = ["dpkg-query", "-S", "/usr/include/boost/version.hpp"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.partition(":")[0]


def _boost_licence() -> str:
    """Return the licence of Boost without the list of authors.

    Debian's file names the authors of every file of Boost, in two megabytes.
    """
    paragraph = re.search(r"^License: BSL-1\.0\n((?: .*\n)+)", _copyright(_boost_package()), re.MULTILINE)[1]
    lines = [line[1:] if line != " ." else "" for line in paragraph.splitlines()]
    return "Boost.Polygon and Boost.Math, copyright of their authors\n\n" + "\n".join(lines) + "\n"


def add_contents(raw: Path, wheel: Path, found: list[Component], epoch_s: int) -> None:
    """Write the wheel raw to wheel, with licences and a bill of materials.

    The order and the times of the files depend only on the arguments.
    """
    with zipfile.ZipFile(raw) as file:
        files = {name: file.read(name) for name in file.namelist() if not name.endswith("/")}
    (info,) = {name.partition("/")[0] for name in files if name.partition("/")[0].endswith(".dist-info")}
    licences = {f"third-party/{_file_name(each.name)}.txt": each.text.encode() for each in found}
    files |= {f"{info}/licenses/{name}": text for name, text in licences.items()}
    files[f"{info}/METADATA"] = _metadata(files[f"{info}/METADATA"].decode(), found, sorted(licences)).encode()
    version = info.removesuffix(".dist-info").partition("-")[2]
    files[f"{info}/{BILL}"] = json.dumps(_bill(version, found, epoch_s), indent=1).encode() + b"\n"
    record = f"{info}/RECORD"
    del files[record]
    files = dict(sorted(files.items()))
    lines = [f"{name},sha256={_digest(data)},{len(data)}\n" for name, data in files.items()]
    files[record] = "".join([*lines, f"{record},,\n"]).encode()
    date = time.gmtime(max(epoch_s, 315532800))[:6]  # a zip cannot store a time before 1980
    with zipfile.ZipFile(wheel, "w") as out:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, date)
            entry.create_system = 3
            entry.external_attr = (0o100755 if name.endswith(".so") else 0o100644) << 16
            out.writestr(entry, data, zipfile.ZIP_DEFLATED, 9)


def _file_name(name: str) -> str:
    return re.sub(r"[^a-z0-9+]+", "-", name.lower())


def _digest(data: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip("=")


def _metadata(text: str, found: list[Component], licences: list[str]) -> str:
    """Return METADATA with the licences of all code in the wheel, as in PEP 639.

    It also lists the files with the texts of the licences.
    """
    expression = " AND ".join(["MIT", *sorted({each.licence for each in found} - {"MIT"})])
    head, gap, body = text.partition("\n\n")
    lines = [f"License-Expression: {expression}" if line.startswith("License-Expression:") else line
             for line in head.splitlines()]  # fmt: skip
    return "\n".join([*lines, *(f"License-File: {each}" for each in licences)]) + gap + body


def _bill(version: str, found: list[Component], epoch_s: int) -> dict:
    """Return a CycloneDX bill of materials."""
    own = f"pkg:pypi/brushsvg@{version}"
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {
            "timestamp": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(epoch_s)),
            "component": {
                "type": "library",
                "bom-ref": own,
                "name": "brushsvg",
                "version": version,
                "purl": own,
            },
        },
        "components": [
            {
                "type": "library",
                "bom-ref": _file_name(each.name),
                "name": each.name,
                "version": each.version,
                "licenses": [{"expression": each.licence}],
                "purl": each.purl,
            }
            for each in found
        ],
        "dependencies": [
            {"ref": own, "dependsOn": [_file_name(each.name) for each in found]},
            *({"ref": _file_name(each.name)} for each in found),
        ],
    }


def problems_of(wheel: Path) -> list[str]:
    """Return the reasons why a wheel must not be published, a sentence each."""
    problems = []
    if wheel.stat().st_size > LARGEST_BYTES:
        problems.append(f"{wheel.name}: it has {wheel.stat().st_size} bytes (at most {LARGEST_BYTES})")
    with zipfile.ZipFile(wheel) as file:
        names = file.namelist()
        if not any(name.endswith(f".dist-info/{BILL}") for name in names):
            problems.append(f"{wheel.name}: the bill of materials {BILL} is missing")
        else:
            problems += _without_licence(wheel, file)
        for name in names:
            if any(word in name.lower() for word in FORBIDDEN):
                problems.append(f"{wheel.name}: {name}: a library under the GPL, or one that needs such a library")
            if re.search(r"\.so(\.|$)", name):
                problems += [f"{wheel.name}: {name}: {why}" for why in problems_of_library(file.read(name))]
    return problems


def _without_licence(wheel: Path, file: zipfile.ZipFile) -> Iterator[str]:
    (bill,) = (name for name in file.namelist() if name.endswith(f".dist-info/{BILL}"))
    for each in json.loads(file.read(bill))["components"]:
        text = f"{bill.partition('/')[0]}/licenses/third-party/{each['bom-ref']}.txt"
        if text not in file.namelist():
            yield f"{wheel.name}: the licence of {each['name']} is missing ({text})"


def problems_of_library(data: bytes) -> Iterator[str]:
    """Yield the reasons why a shared library must not be in a wheel."""
    # Ceres contains sentences about its own build, and the name of LAPACK, without which it was built.
    said = re.sub(rb"Ceres was (?:not built with|compiled without) support for \w+\.|\0LAPACK(?=\0)", b"", data)
    for word in FORBIDDEN:
        if re.search(rb"(?i)(?:\blib|\b)%s(?:[_-]\w+)?[(.\0]" % word.encode(), said):
            yield f"it contains or needs {word}"
    with tempfile.NamedTemporaryFile(suffix=".so") as library:
        library.write(data)
        library.flush()
        dynamic = _output("readelf", "--dynamic", "--wide", library.name)
        symbols = _output("nm", "--dynamic", "--defined-only", library.name)
    for needed in sorted(set(re.findall(r"\(NEEDED\).*\[(.+)\]", dynamic)) - SYSTEM_LIBRARIES):
        yield f"it needs {needed}, which not every system has"
    exported = {line.split()[-1] for line in symbols.splitlines()}
    if others := sorted(name for name in exported if not name.startswith("PyInit_")):
        yield f"it exports {len(others)} symbols to other libraries, such as {others[0]}"
    if re.search(rb"/(?:home|root|tmp|build)/[\w.-]+/", data):
        yield "it contains the path of a folder of the machine that compiled it"


def _output(*words) -> str:
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def page(wheel: Path, report: str) -> str:
    """Return the page of the documentation about the contents of a wheel."""
    with zipfile.ZipFile(wheel) as file:
        (bill,) = (name for name in file.namelist() if name.endswith(f".dist-info/{BILL}"))
        text = file.read(bill).decode()
    rows = [f"| {each['name']} | {each['version']} | {each['licenses'][0]['expression']} | `{each['purl']}` |"
            for each in json.loads(text)["components"]]  # fmt: skip
    summary = " ".join(report.split())
    return "\n".join(
        [
            "# What the wheels contain\n",
            "This page is for you if you package brushsvg or have to know its licences. `make wheel-docs` writes it.\n",
            "brushsvg itself is MIT. The compiled module in a wheel contains code of these libraries:\n",
            "| library | version | license | source |\n|---|---|---|---|",
            *rows,
            "",
            "Their license texts are in the wheel, in `licenses/third-party/` of its `.dist-info` folder. No library",
            "under the GPL is inside: Ceres is built without SuiteSparse and LAPACK, and Eigen refuses to compile any",
            "part that is not under the MPL (`EIGEN_MPL2_ONLY`). Eigen's unchanged source is Debian's package.\n",
            f"## auditwheel\n\n{summary}\n",
            f"## Bill of materials\n\nThe file `{BILL}` in the `.dist-info` folder (CycloneDX):\n",
            f"```json\n{text.rstrip()}\n```\n",
        ]
    )


def main(words: list[str]) -> int | str:
    """Run one of the two commands."""
    if len(words) == 2 and words[0] == "check":
        return "\n".join(problems_of(Path(words[1])))
    if len(words) == 4 and words[0] == "page":
        Path(words[3]).write_text(page(Path(words[1]), Path(words[2]).read_text()))
        return 0
    return __doc__


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
