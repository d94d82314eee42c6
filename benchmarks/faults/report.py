"""Report the outcomes of the faults as tables."""

from __future__ import annotations

import tomllib
from collections import Counter, defaultdict
from pathlib import Path

from fault import Fault
from run import Outcome, Test, reaching

EQUIVALENT = Path(__file__).parent / "equivalent.toml"


def equivalents() -> dict[tuple, str]:
    """Return {identity of a fault: why it changes nothing important}."""
    with EQUIVALENT.open("rb") as file:
        listed = tomllib.load(file).get("fault", [])
    return {tuple(each[key] for key in ("file", "code", "column", "change")): each["reason"] for each in listed}


def report(faults: list[Fault], outcomes: dict[int, Outcome], tests: dict[str, Test], hits: dict[int, set[str]]) -> str:
    known = equivalents()
    lines = ["| | place | kind | change | | test |", "|--:|---|---|---|---|---|"]
    totals: dict[str, Counter] = defaultdict(Counter)
    for fault in faults:
        verdict, by = judged(fault, outcomes.get(fault.number), known, bool(hits.get(fault.number)))
        totals[fault.place][verdict] += 1
        cells = [
            str(fault.number),
            f"{fault.file}:{fault.line}",
            fault.kind,
            f"`{fault.change}`",
            verdict,
            by,
        ]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    verdicts = ["ci", "thorough", "equivalent", "survived", "not tried"]
    lines += [
        "",
        "| package | faults | " + " | ".join(verdicts) + " |",
        "|---|" + "--:|" * (len(verdicts) + 1),
    ]
    whole: Counter = Counter()
    for folder, counts in sorted(totals.items()):
        whole += counts
        lines.append(row(folder, counts, verdicts))
    lines.append(row("all", whole, verdicts))
    caught = whole["ci"] + whole["thorough"]
    if caught:
        lines += ["", f".ci/run catches {whole['ci']} of the {caught} faults that any test catches: "]
        lines[-1] += f"{100 * whole['ci'] / caught:.1f} %"
    failing = sorted(test.name for test in tests.values() if test.outcome == "failed")
    lines += ["", f"Tests that fail in the planted tree without a fault, and were left out: {len(failing)}"]
    lines += [f"* {name}" for name in failing]
    unreliable = sorted({name for outcome in outcomes.values() for name in outcome.unreliable})
    lines += ["", f"Tests that failed with a fault and, alone, without: {len(unreliable)}"]
    lines += [f"* {name}" for name in unreliable]
    return "\n".join(lines) + "\n"


def row(name: str, counts: Counter, verdicts: list[str]) -> str:
    return f"| {name} | {counts.total()} | " + " | ".join(str(counts[each]) for each in verdicts) + " |"


def judged(fault: Fault, outcome: Outcome | None, known: dict, hit: bool) -> tuple[str, str]:
    if outcome is None:
        return "not tried", ""
    if outcome.tier:
        late = " (took too long)" if outcome.why.startswith("TimeLimitError") else ""
        return outcome.tier, outcome.test + late
    if reason := known.get(fault.identity):
        return "equivalent", reason
    if not hit:
        return "survived", "no test comes by, or none where it makes a difference"
    left = f", {outcome.left} were left by the budget" if outcome.left else ""
    return "survived", f"{outcome.tried} tests ran{left}"


def details(
    faults: list[Fault], outcomes: dict[int, Outcome], tests: dict[str, Test], hits: dict[int, set[str]]
) -> str:
    """Return the survivors as entries for equivalent.toml, to be judged by a person."""
    known, lines = equivalents(), []
    for fault in faults:
        outcome = outcomes.get(fault.number)
        if judged(fault, outcome, known, bool(hits.get(fault.number)))[0] != "survived":
            continue
        direct, near = reaching(tests, hits.get(fault.number, set()))
        lines += [
            f"# {fault.number} {fault.place}, {fault.kind}: {len(direct)} tests come by, {len(near)} may",
            *(f"#   {test.name}" for test in direct[:5]),
            "[[fault]]",
            f'file = "{fault.file}"  # line {fault.line}',
            f"code = '''{fault.code}'''",
            f"column = {fault.column}",
            f"change = '''{fault.change}'''",
            'reason = ""',
            "",
        ]
    return "\n".join(lines)
