"""Run the tests with other arithmetic and list the changes: `make test-variants`.

Processors differ in the last bits of sums and functions. The reasons are fused multiply-adds and other
kernels of OpenBLAS, numpy and glibc. No test may depend on these bits. A variant imitates a processor: all
code calculates as it would calculate there. If a test fails with a variant, run it with each part of the
variant. Parts are variants as well.

    tools/test_variants.py --variant haswell --variant glibc-no-fma --suite python --tests 'test_fit*'
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import sysconfig
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SITE = ROOT / "tools/variant_site"
BUILDS = ROOT / "build/variants"
OPENBLAS_CORES = ("Nehalem", "Haswell", "Zen", "SkylakeX")
# The parts from find_variants that imitate these processors. The first has no FMA, the second no AVX-512.
PROCESSORS = {
    "nehalem": ("glibc-no-fma", "numpy-baseline", "openblas-nehalem"),
    "haswell": ("v3-fma", "numpy-no-avx512", "openblas-haswell"),
    "skylake-x": ("openblas-skylakex",),
    "no-contraction": ("no-contract",),
}
PYTEST_SUITES = {
    "python": ["tests/python", "tests/laws", "-m", "not long and not thorough"],
    "laws": ["tests/laws", "-m", "long"],
}
SUITES = ("cpp", *PYTEST_SUITES)
# environment variables that only variants set
SWITCHES = ("OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "GLIBC_TUNABLES")


@dataclass(frozen=True)
class Variant:
    """The differences from the plain build.

    `changes` names the entries of the fingerprint that show the differences.
    """

    name: str
    changes: tuple[str, ...] = ()
    flags: str = ""  # flags of the compiler
    environment: dict[str, str] = field(default_factory=dict)

    @property
    def build(self) -> Path:
        return BUILDS / ("flags" + self.flags.replace(" ", "") if self.flags else "plain")

    @property
    def results(self) -> Path:
        return BUILDS / "results" / self.name


def find_variants(plain: dict) -> list[Variant]:
    """List the parts that can be changed on this processor.

    plain: the fingerprint of the plain build on this processor.
    """
    of_512 = [name for name in plain["numpy"] if name.startswith(("X86_V4", "AVX512"))]
    out = [
        Variant("no-contract", ("core",), "-ffp-contract=off"),
        # Tables of Eigen are passed to the distribution's Ceres, which aligns them by 16 bytes.
        Variant("v3-fma", ("core",), "-march=x86-64-v3 -ffp-contract=fast -DEIGEN_MAX_ALIGN_BYTES=16"),
    ]
    for name, changes, switch, value in (
        ("glibc-no-fma", "glibc", "GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"),
        ("numpy-no-avx512", "numpy", "NPY_DISABLE_CPU_FEATURES", " ".join(of_512)),
        ("numpy-baseline", "numpy", "NPY_DISABLE_CPU_FEATURES", " ".join(plain["numpy"])),
        *((f"openblas-{core.lower()}", "blas", "OPENBLAS_CORETYPE", core) for core in OPENBLAS_CORES),
    ):
        out.append(Variant(name, (changes,), environment={switch: value}))
    return out


def together(name: str, parts: list[Variant]) -> Variant:
    changes = tuple(dict.fromkeys(change for part in parts for change in part.changes))
    environment = {key: value for part in parts for key, value in part.environment.items()}
    return Variant(name, changes, " ".join(part.flags for part in parts if part.flags), environment)


def run(*words: str | Path, **settings) -> subprocess.CompletedProcess:
    print("+", *words, flush=True)
    return subprocess.run([str(word) for word in words], cwd=ROOT, **settings)


def build(variant: Variant, targets: list[str]) -> None:
    folder = variant.build
    pybind11 = subprocess.check_output([sys.executable, "-m", "pybind11", "--cmakedir"], text=True).strip()
    settings = {
        "CMAKE_BUILD_TYPE": "Release",
        "CMAKE_CXX_FLAGS": variant.flags,
        "BRUSHSVG_PYTHON": "ON",
        "BRUSHSVG_TESTS": "ON",
        "BRUSHSVG_FIT": "ON",
        "Python_EXECUTABLE": sys.executable,
        "pybind11_DIR": pybind11,
    }
    if subprocess.run(["which", "ccache"], capture_output=True).returncode == 0:
        settings["CMAKE_CXX_COMPILER_LAUNCHER"] = "ccache"
    run("cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", *[f"-D{k}={v}" for k, v in settings.items()],
        check=True, stdout=subprocess.DEVNULL)  # fmt: skip
    run("cmake", "--build", folder, "--target", *targets, check=True)


def core_of(variant: Variant) -> str:
    return str(variant.build / f"_core{sysconfig.get_config_var('EXT_SUFFIX')}")


def environment_of(variant: Variant) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if name not in SWITCHES}
    paths = [str(SITE), *filter(None, [os.environ.get("PYTHONPATH")])]
    ours = {"PYTHONPATH": os.pathsep.join(paths), "BRUSHSVG_VARIANT_CORE": core_of(variant)}
    return kept | ours | variant.environment


def fingerprint(variant: Variant) -> dict:
    words = [sys.executable, SITE / "fingerprint.py"]
    found = json.loads(subprocess.check_output(words, env=environment_of(variant), cwd=ROOT))
    if found["core_file"] != core_of(variant):
        raise SystemExit(f"{variant.name}: the tests import {found['core_file']}")
    return found


def why_skipped(variant: Variant, found: dict, known: dict[str, dict]) -> str:
    """Return why a variant is skipped, or "" if it has to run.

    A variant is skipped if an earlier one calculates like it. A variant with its own build always runs.
    """
    if variant.flags:
        return ""
    alike = [name for name, other in known.items() if all(found[change] == other[change] for change in variant.changes)]
    return f"skipped: calculates like {alike[0]} on this processor" if alike else ""


def read_junit(path: Path) -> dict[str, bool]:
    """Return whether each test passed; skipped tests are left out."""
    out = {}
    for case in ElementTree.parse(path).iter("testcase"):
        if case.find("skipped") is None:
            name = f"{case.get('classname')}::{case.get('name')}"
            out[name] = case.find("failure") is None and case.find("error") is None
    return out


def read_doctest(path: Path) -> dict[str, bool]:
    out = {}
    for case in ElementTree.parse(path).iter("TestCase"):
        result = case.find("OverallResultsAsserts")
        if result is not None:
            out[case.get("name")] = result.get("test_case_success") == "true"
    return out


def run_suite(variant: Variant, suite: str, patterns: list[str], processes: str) -> dict[str, bool]:
    """Run the tests in files that match a pattern; return whether each test passed."""
    variant.results.mkdir(parents=True, exist_ok=True)
    report = variant.results / f"{suite}.xml"
    report.unlink(missing_ok=True)
    if suite == "cpp":
        files = [f"--source-file={','.join(f'*{pattern}.cpp' for pattern in patterns)}"] if patterns else []
        words = [variant.build / "tests/cpp/brushsvg_tests", "--reporters=xml", f"--out={report}", *files]
        read = read_doctest
    else:
        *folders, dash_m, marker = PYTEST_SUITES[suite]
        files = list(matching(folders, patterns)) if patterns else folders
        if not files:
            return {}
        words = [sys.executable, "-m", "pytest", *files, dash_m, marker, "-n", processes, "--dist", "worksteal",
                 "--tb=short", f"--junit-xml={report}"]  # fmt: skip
        read = read_junit
    with open(variant.results / f"{suite}.log", "w") as log:
        code = run(*words, env=environment_of(variant), stdout=log, stderr=subprocess.STDOUT).returncode
    if suite != "cpp" and code == 5:  # no test has this marker
        return {}
    try:
        out = read(report)
    except (OSError, ElementTree.ParseError):
        out = {}
    if code and all(out.values()):
        out[f"(ended with code {code}: see {variant.results / suite}.log)"] = False
    return out


def matching(folders: list[str], patterns: list[str]) -> Iterator[Path]:
    for folder in folders:
        for path in sorted((ROOT / folder).glob("test_*.py")):
            if any(fnmatch(path.stem, pattern) for pattern in patterns):
                yield path


def differences(now: dict[str, bool], plain: dict[str, bool]) -> list[str]:
    """Return the tests that pass in one of two runs and fail in the other."""
    words = {True: "passes", False: "fails"}
    return [f"{name} {words[now[name]]}" for name in now if name in plain and now[name] != plain[name]]


def read_options() -> argparse.Namespace:
    formatter = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=formatter)
    add = parser.add_argument
    add(
        "--variant",
        action="append",
        help="processor or part; repeat it for more (default: plain and processors)",
    )
    add(
        "--suite",
        action="append",
        choices=SUITES,
        help="run only this one; repeat it for more (default: all)",
    )
    add("--tests", action="append", default=[], metavar="PATTERN", help="run only test files with such a name")
    add("--processes", default="auto", metavar="N", help="of pytest, as its -n (default: auto)")
    add("--list", action="store_true", help="build plain, list the variants, and run no test")
    return parser.parse_args()


def main() -> int:
    options = read_options()
    suites = options.suite or list(SUITES)

    plain = Variant("plain")
    targets = ["_core", *(["brushsvg_tests"] if "cpp" in suites else [])]
    build(plain, targets)
    known = {"plain": fingerprint(plain)}
    parts = {variant.name: variant for variant in find_variants(known["plain"])}
    processors = [together(name, [parts[part] for part in made_of]) for name, made_of in PROCESSORS.items()]
    variants = [plain, *processors, *parts.values()]
    names = [variant.name for variant in variants]
    if unknown := set(options.variant or []) - set(names):
        raise SystemExit(f"unknown variant {', '.join(sorted(unknown))}: choose from {', '.join(names)}")
    chosen = options.variant or [variant.name for variant in (plain, *processors)]
    variants = [variant for variant in variants if variant.name in chosen]

    rows, results = [], {}
    for variant in variants:
        if variant.flags and not options.list:
            build(variant, targets)
        if variant is not plain and not (variant.flags and options.list):
            found = fingerprint(variant)
            if skipped := why_skipped(variant, found, known):
                rows.append((variant.name, "", skipped))
                continue
            known[variant.name] = found
        if options.list:
            rows.append((variant.name, "", "runs here"))
            continue
        for suite in suites:
            now = results[variant.name, suite] = run_suite(variant, suite, options.tests, options.processes)
            failed = [name for name, passed in now.items() if not passed]
            rows.append((variant.name, suite, f"{len(now) - len(failed)} passed, {len(failed)} failed"))
            rows += [("", "", f"  {name}") for name in failed]
            changed = differences(now, results.get(("plain", suite), {}))
            rows += [("", "", f"  unlike the plain build: {line}") for line in changed]
        if variant.flags and found["core"] == known["plain"]["core"]:
            rows.append(("", "", "  a plan and its marks are bit for bit those of the plain build"))
    print()
    for name, suite, line in [("variant", "suite", "outcome"), *rows]:
        print(f"{name:18} {suite:7} {line}")
    print()
    for name, made_of in PROCESSORS.items():
        print(f"{name:18} {', '.join(made_of)}")
    return int(any(not passed for now in results.values() for passed in now.values()))


if __name__ == "__main__":
    raise SystemExit(main())
