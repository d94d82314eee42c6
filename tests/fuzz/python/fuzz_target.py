"""Runs one fuzz target of the Python package: fuzz_target.py NAME, then what libFuzzer takes.

Guided by coverage where Atheris is installed. Elsewhere the seeds are changed at random, which the first line says; of
the flags it then knows -max_total_time, -timeout, -rss_limit_mb, -artifact_prefix, -runs and -seed. A path of a single
file runs that file alone, as libFuzzer does.
"""

from __future__ import annotations

import hashlib
import logging
import os
import random
import resource
import signal
import sys
import time
import traceback
import warnings
from pathlib import Path

try:
    import atheris
except ImportError:
    atheris = None

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
INSTRUMENTED = ["brushsvg", "tinycss2", "cssselect2"]


def main(argv: list[str]) -> int:
    name, *flags = argv[1:]
    if atheris:
        with atheris.instrument_imports(include=INSTRUMENTED):
            import targets

            target, seeds = targets.TARGETS[name], targets.seeds_of(name)
            _import_all(target, seeds)
    else:
        import targets

        target, seeds = targets.TARGETS[name], targets.seeds_of(name)
    import mutators

    logging.disable()  # ezdxf and fontTools log what damaged files hold
    warnings.simplefilter("ignore")
    if not atheris:
        return _at_random(targets, mutators, target, seeds, flags)

    def mutate(data: bytes, most_bytes: int, seed: int) -> bytes:
        choose = random.Random(seed)
        if choose.random() < 0.3 and target.form != "picture":
            return atheris.Mutate(data, most_bytes)
        return mutators.structured(data, target, seeds, choose)[:most_bytes]

    atheris.Setup(
        [argv[0], f"-max_len={target.most_bytes}", *flags],
        lambda data: targets.judged(target, data),
        custom_mutator=mutate,
    )
    atheris.Fuzz()
    return 0


def _import_all(target, seeds: list[bytes]) -> None:
    """Targets import what they read with when they first run: it must be while imports are instrumented."""
    for data in seeds[:3]:
        try:
            target.read(data)
        except Exception:  # the first run of the fuzzer meets it again, and reports it
            return


def _at_random(targets, mutators, target, seeds: list[bytes], flags: list[str]) -> int:
    print("Atheris is not installed: the seeds are changed at random, without coverage", file=sys.stderr)
    given = dict(flag[1:].split("=", 1) for flag in flags if flag.startswith("-") and "=" in flag)
    files = [Path(flag) for flag in flags if not flag.startswith("-") and os.path.isfile(flag)]
    until = time.monotonic() + float(given.get("max_total_time", 0) or 1e9)
    most_runs = int(given.get("runs", -1))
    choose = random.Random(int(given.get("seed", 0)) or None)
    limit = int(given.get("timeout", 10))
    memory_mb = int(given.get("rss_limit_mb", 0))

    def over_time(*_):
        raise TimeoutError(f"longer than {limit} s")

    signal.signal(signal.SIGALRM, over_time)
    known, runs = list(seeds), 0
    queue = [path.read_bytes() for path in files] or list(seeds)
    while queue or (not files and time.monotonic() < until and runs != most_runs):
        data = queue.pop() if queue else choose.choice(known)
        if not files and runs >= len(seeds):
            if choose.random() < 0.3 and target.form != "picture":
                data = mutators.change_bytes(data, choose)
            else:
                data = mutators.structured(data, target, seeds, choose)
            data = data[: target.most_bytes]
        runs += 1
        signal.alarm(limit)
        try:
            targets.judged(target, data)
            used_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            if memory_mb and used_mb > memory_mb:
                raise MemoryError(f"{used_mb:.0f} MB")
            if choose.random() < 0.01 and len(known) < 1000:
                known.append(data)
        except Exception:
            signal.alarm(0)
            traceback.print_exc()
            kept = f"{given.get('artifact_prefix', './')}crash-{hashlib.sha1(data).hexdigest()}"
            Path(kept).write_bytes(data)
            print(f"Test unit written to {kept}", file=sys.stderr)
            return 77
        finally:
            signal.alarm(0)
    print(f"#{runs} DONE cov: 0 ft: 0 corp: {len(known)}/0b", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
