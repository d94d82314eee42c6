"""Plant faults in all sources, and find which tests catch them.

    pip install tree-sitter tree-sitter-cpp     # in the Python that runs this program
    python benchmarks/faults plant              # copy and build the tree with 100 faults, each switched off
    python benchmarks/faults map [PATH ...]     # run all tests once, and record the faults and duration of each;
                                                # use --tier ci first, then the others for surviving faults
    python benchmarks/faults try                # switch each fault on, for the tests that reach it
    python benchmarks/faults report             # print a table, totals, and the survivors

A seed chooses the faults: at least one in each folder of code, and the rest by lines. The eight kinds are as
even as possible: changed comparisons and arithmetic operators, swapped `and` and `or`, negated conditions,
changed numbers and constants, removed calls, empty results. All faults are in one build (mutant schemata,
Untch et al. 1993). `a < b` becomes `(a <= b) if __fault__(17) else (a < b)`. The switch is on in processes
whose environment has BRUSHSVG_FAULT=17, also in commands that a test starts. So trying a fault needs only the
tests that reach it, a second or two for most.

A test reaches a comparison, `and` or `or` only if the fault makes a difference. A test may use a result of
another test in a fixture or a cache. So after the tests that reach a fault, the other tests of their files
and shared fixtures run. A test catches a fault if it passes without the fault, and with it fails, dies, or
takes more than five times its duration plus half a minute. Tests that fail in the planted tree without a
fault (some read the sources) do not count. The linters, sanitizers and tests/consumer do not run.

Tests of .ci/run come first. Faults that none of them catches go to the tests marked `thorough`. Every step
continues where it stopped. You may delete the work folder (--work). A person judges the survivors:
equivalent.toml lists those that change nothing important, with the reason.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from fault import read_faults
from run import Tree

ROOT = Path(__file__).parents[2]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("step", choices=["plant", "map", "try", "report"])
    parser.add_argument("paths", nargs="*", help="of tests to map; cpp: those of C++ (default: all)")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "faults", help="folder (default: %(default)s)")
    parser.add_argument("--root", type=Path, default=ROOT, help="tree to plant in (default: this one)")
    parser.add_argument(
        "--tier",
        choices=["ci", "all"],
        default="all",
        help="of tests to map; ci: those of .ci/run (default: all)",
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--python", type=int, default=65, help="faults in Python (default: %(default)s)")
    parser.add_argument("--cpp", type=int, default=35, help="faults in C++ (default: %(default)s)")
    parser.add_argument(
        "--safety",
        type=int,
        default=0,
        metavar="N",
        help="instead: N faults in each language and part of the code that keeps a robot within its bounds (safety.py)",
    )
    parser.add_argument("--jobs", type=int, default=2, help="processes at a time (default: %(default)s)")
    parser.add_argument("--budget", type=float, default=900.0, help="seconds of tests for a fault and tier")
    parser.add_argument("--again", action="store_true", help="try survivors again, too")
    parser.add_argument("--only", type=int, nargs="+", help="numbers of faults to try")
    args = parser.parse_intermixed_args()
    work = args.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    tree = Tree(work)
    if args.step == "plant":
        from plant import plant

        for fault in plant(args.root.resolve(), work, args.seed, args.python, args.cpp, args.safety):
            print(f"{fault.number:3} {fault.file}:{fault.line} {fault.kind}: {fault.change}")
        return
    faults = read_faults(work)
    if args.step == "map":
        tree.map_tests(args.paths, args.jobs, args.tier)
    elif args.step == "try":
        if not tree.tiers.exists():
            tree.collect_tiers()
        chosen = [fault for fault in faults if not args.only or fault.number in args.only]
        tree.try_all(chosen, args.jobs, args.budget, args.again)
    else:
        from report import details, report

        known = (faults, tree.outcomes(), tree.tests(), tree.hits())
        text = report(*known)
        (work / "report.md").write_text(text, encoding="utf-8")
        (work / "survivors.toml").write_text(details(*known), encoding="utf-8")
        print(text)
        print(f"{work}/survivors.toml: the survivors, as entries for equivalent.toml")


if __name__ == "__main__":
    main()
