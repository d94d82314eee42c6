"""Plant faults all over the sources, and see which tests catch them.

    pip install tree-sitter tree-sitter-cpp     # in the Python that runs this
    python benchmarks/faults plant              # a copy of the tree with 100 faults, each switched off; built
    python benchmarks/faults map [PATH ...]     # all tests once: who comes by which fault, and how long each takes;
                                                # --tier ci first, and the others where faults survive
    python benchmarks/faults try                # each fault switched on, for the tests that come by
    python benchmarks/faults report             # a table, totals, and the survivors

Which faults: seeded, at least one in each folder of code, the rest by lines; of eight kinds as evenly as it goes:
comparisons and arithmetic operators changed, `and` and `or` swapped, conditions negated, numbers and constants changed,
calls removed, results made empty. All are in one build (mutant schemata, Untch et al. 1993): `a < b` is written as
`(a <= b) if __fault__(17) else (a < b)`, and the switch is on in processes whose environment has BRUSHSVG_FAULT=17,
commands that a test starts among them. So a fault costs the tests that come by it, a second or two for most.

A comparison or `and`, `or` is only come by where it makes a difference. A test may find a result made by another, in a
fixture or a cache: after the tests that come by a fault, the others of their files and of their shared fixtures run.
A test catches a fault if it fails, dies or takes five times as long and half a minute more with it, and passes without.
Tests that do not pass in the planted tree without a fault (some read the sources) count for nothing. The linters,
sanitizers and tests/consumer are not run.

Tests of .ci/run come first; what none of them catches goes to the tests marked `thorough`. Every step goes on where it
was stopped; what is in the work folder (--work) may be deleted. Survivors are judged by hand: those that change nothing
that matters are listed in equivalent.toml, with the reason.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from fault import read_faults
from run import Tree

ROOT = Path(__file__).parents[2]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("step", choices=["plant", "map", "try", "report"])
    parser.add_argument("paths", nargs="*", help="of tests to map; cpp: those of C++ (default: all)")
    parser.add_argument(
        "--work", type=Path, default=ROOT / "build" / "faults", help="folder (default: %(default)s)"
    )
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
