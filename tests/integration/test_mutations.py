"""`brushsvg check` agrees with the judge about damaged programs.

The judge shares no code with check. The sample has a thousand programs per dialect, or 300;
benchmarks/mutations.py runs a thousand for each of the ten jobs.
"""

import re
import subprocess

import numpy as np
import pytest
from judge import verdict
from judge.damage import DAMAGES, damaged
from judge.table import Figures, measure
from judge.verdict import judged
from judge.works import CELLS, FEWER, LIKE_GRBL, WORKS, make
from sampling import sample

A_JOB = 100
SEED = 1
# With seed 1, check refuses 5 of 248 harmless programs, one more than 2 in 100. Of 10,000 it refuses fewer.
SEEDS = {"urscript": 2}
WHOLE_NUMBERS = ("ebb", "hpgl")  # languages with only whole numbers
EVEN_FOR_RS274 = ("a curve", "circles", "corners", "leaning", "paint")


def made(name, dialect, tmp_path):
    return make(name, dialect, tmp_path / dialect / str(list(WORKS).index(name)))


@sample("dialect", CELLS, keep=3)
def test_check_separates_dangerous_from_harmless(dialect, tmp_path, capsys):
    figures = Figures()
    for name in WORKS:
        measure(
            made(name, dialect, tmp_path),
            30 if dialect in FEWER else A_JOB,
            SEEDS.get(dialect, SEED),
            figures,
        )
    with capsys.disabled():
        print("\n" + figures.table())
    allowed = [case for case in figures.cases if case.verdict == "dangerous" and not case.refusals]
    refused = [case for case in figures.cases if case.verdict == "harmless" and case.refusals]
    assert figures.crashes == []
    assert allowed == []
    least = 30 if dialect in FEWER else A_JOB
    holds = (
        50 * len(refused) < figures.of(dialect, "harmless"),
        4 * figures.of(dialect, "neither") <= figures.of(dialect),
        # both kinds are in the sample
        figures.of(dialect, "harmless") > least < figures.of(dialect, "dangerous"),
    )
    if dialect == "ebb" and not all(holds):
        pytest.xfail("slices of 16 ms: of 2,000 programs 7 of 189 harmless ones are refused, and 609 are neither")
    assert all(holds), (holds, refused)


@sample("dialect", [name for name in CELLS if name not in LIKE_GRBL], keep=3)
def test_the_judge_separates_dangerous_and_harmless_damage(dialect, tmp_path):
    """The judge separates dangerous and harmless damage of every kind.

    Otherwise the table above would mean nothing.
    """
    whole = made("two lines", dialect, tmp_path).whole
    assert judged(whole.text, whole) == ("harmless", "")
    seen = {name: set() for name in DAMAGES}
    for name, text in damaged(whole.text, dialect, 300 if dialect in WHOLE_NUMBERS else 600, 7):
        seen[name].add(judged(text, whole)[0])
    always = {"strokes swapped", "stroke lost", "stroke doubled", "stroke reversed"}
    for name in always:
        assert seen[name] <= {"dangerous"}, name
    assert seen["remark"] == seen["blank line"] == {"harmless"}
    for name in ("sign", "digit", "line lost", "line moved", "mode"):
        assert "dangerous" in seen[name], name
    assert "neither" in seen["header"]
    assert "harmless" in seen["last digit"] or (dialect in WHOLE_NUMBERS and not seen["last digit"])


def test_a_retract_of_a_hundred_metres_is_judged_without_millions_of_samples(tmp_path, monkeypatch):
    """A retract of a hundred metres needs few samples; it once used twenty gigabytes."""
    whole = made("corners", "linuxcnc", tmp_path).whole
    most = 0

    def sampled(points):
        nonlocal most
        most = max(most, float(np.ptp(points, axis=0).max()))
        return points

    monkeypatch.setattr(verdict, "_sampled", sampled)
    last = [line for line in whole.text.split("\n") if line.startswith("G0 X")][-1]
    high = last.replace("Z10.0000", "Z99910.0000")
    text = high.join(whole.text.rsplit(last, 1))
    assert judged(text, whole)[0] == "neither"
    assert most < 1e3


def test_a_setting_that_shifts_the_next_program_is_not_harmless(tmp_path):
    """A setting that shifts the next program is not harmless.

    G54 may be a different system from the active one. G92 stays after the program, and so does G91 if no M2
    resets it.
    """
    for dialect in ("linuxcnc", "grbl", "grbl-servo"):
        whole = made("two lines", dialect, tmp_path).whole
        first, _, rest = whole.text.partition("\n\n")
        assert judged(f"{first}\nG54\n\n{rest}", whole)[0] == "neither"
        end = "(end:" if dialect == "grbl-servo" else "M2\n"
        for line in ("G92 X0 Y0", "G91"):
            says = judged(whole.text.replace(end, f"{line}\n{end}"), whole)[0]
            assert says == ("harmless" if line == "G91" and end == "M2\n" else "neither")


RS274_SILENT = re.compile("compensation|mode|%|return|places|system|length|M2|letters|comment")


def rs274(text, folder):
    """Return (refused, legs) as LinuxCNC's own interpreter prints them."""
    (folder / "p.ngc").write_bytes(text.encode("latin-1"))
    (folder / "rs274ngc.var").touch()
    done = subprocess.run(
        ["rs274", "-g", "p.ngc"], cwd=folder, capture_output=True, timeout=60, encoding="latin-1", check=False
    )
    legs, feed = [], 0.0
    for line in done.stdout.splitlines():
        if not (found := re.fullmatch(r" *\d+ N\.* +(\w+)\((.*)\)", line)):
            continue
        name, words = found.groups()
        if name == "SET_FEED_RATE":
            feed = float(words) / 60
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            place = [float(word) for word in words.split(",")[:3]]
            legs.append(("rapid" if name == "STRAIGHT_TRAVERSE" else "feed", *place, feed))
        elif name == "ARC_FEED":
            x, y, centre_x, centre_y, turn, z = (float(word) for word in words.split(",")[:6])
            legs.append(("arc", x, y, z, feed, centre_x, centre_y, turn))
    return done.returncode != 0, legs


@pytest.mark.parametrize("name", EVEN_FOR_RS274)
def test_the_judge_agrees_with_linuxcnc(name, tmp_path):
    """The judge and LinuxCNC agree on moves and refusals, also for damaged programs."""
    whole = made(name, "linuxcnc", tmp_path).whole
    compared = 0
    for damage, text in [("", whole.text), *damaged(whole.text, "linuxcnc", 60, 77)]:
        run = whole.job.interpret(text)
        if damage in ("mode", "cut off", "acting comment") or any(map(RS274_SILENT.search, run.acts)):
            continue  # LinuxCNC would execute an action that the judge reports
        if "G21" not in text or not re.search("(?m)^G0 Z", text):
            continue
        refused, legs = rs274(text, tmp_path)
        ours = [leg for leg in run.legs if leg.kind in ("rapid", "feed", "arc")]
        assert refused == bool(run.refused), (text, run.refused)
        if not refused:
            assert len(legs) == len(ours)
        compared += 1
        known = [False] * 3  # nobody knows where the tool is before the program
        for leg, theirs in zip(ours, legs, strict=False):
            assert leg.kind == theirs[0]
            known = [is_so or abs(a - b) < 2e-4 for is_so, a, b in zip(known, leg.end, theirs[1:4], strict=True)]
            for is_so, a, b in zip(known, leg.end, theirs[1:4], strict=True):
                assert not is_so or a == pytest.approx(b, abs=2e-4), (damage, leg, theirs)
            if leg.kind != "rapid":
                assert leg.speed_mm_s == pytest.approx(theirs[4], abs=1e-4)
            if leg.kind == "arc":
                assert leg.centre == pytest.approx(theirs[5:7], abs=2e-4)
                assert leg.turn == theirs[7]
        assert all(known) or refused or len(ours) < 3
    assert compared > 30
