"""Run the scripts of figures/ and make a page of their pictures, numbers and code.

A script uses public names only, in at most 40 lines. It leaves `figure`, a matplotlib Figure, and `rows`: (name, the
printed number or None, our number). Its docstring is the title and the remarks, for example why a printed value cannot
be reproduced.
"""

from __future__ import annotations

import io
import runpy
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

SCRIPTS = Path(__file__).with_name("figures")
DOTS_PER_INCH = 90  # 720 pixels wide: read on a page without zooming, some 30 kB each

TOP = """# The article, figure by figure

This page is for everyone who knows the article and wants to compare its figures with those that brushsvg computes.

The article is "Physically Motivated Model of a Painting Brush for Robotic Painting and Calligraphy" (Robotics 2024,
13(6), 94). `python examples/article docs/explanation` writes this page.

It needs matplotlib. Below each figure is a table: the printed value, the computed value, and the difference. An empty
cell was not printed. Lengths are in mm, and z is the press depth. Each figure is a short script, which uses
the public names of brushsvg only and can be copied. [The equations](../reference/equations.md) say where the print
is wrong.

Figures 5 (a flow chart) and 8 (photographs of the set-up and the brush) are not drawn.
"""


@dataclass(frozen=True)
class Drawn:
    """One figure: name of its script, title, remarks, rows and picture (PNG)."""

    name: str
    title: str
    remarks: str
    rows: list[tuple[str, float | None, float]]
    picture: bytes


def article_page(stage: Callable[[str], None] = lambda text: None) -> dict[str, bytes]:
    """Return the files of the page by their paths: article.md and its pictures, article/NAME.png.

    stage: called with the name of each script before it runs. Takes half a minute at most.
    """
    drawn = []
    for path in sorted(SCRIPTS.glob("*.py")):
        stage(f"drawing {path.stem}")
        drawn.append(run(path))
    page = "\n".join([TOP, *map(_section, drawn)])
    return {"article.md": page.encode()} | {f"article/{one.name}.png": one.picture for one in drawn}


def run(path: Path) -> Drawn:
    """Run a script and draw its figure."""
    left = runpy.run_path(str(path))
    title, _, remarks = left["__doc__"].strip().partition("\n\n")
    out = io.BytesIO()
    left["figure"].savefig(out, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
    return Drawn(path.stem, title, remarks.strip(), left["rows"], out.getvalue())


def _section(one: Drawn) -> str:
    table = ["| | printed | ours | difference |", "|---|---|---|---|"]
    for what, printed, ours in one.rows:
        known = printed is not None
        cells = [
            what,
            _number(printed) if known else "",
            _number(ours),
            _number(ours - printed) if known else "",
        ]
        table.append(f"| {' | '.join(cells)} |")
    script = f"Script: `examples/article/figures/{one.name}.py`"
    parts = [
        f"## {one.title}",
        one.remarks,
        f"![{one.title}](article/{one.name}.png)",
        "\n".join(table),
        script,
    ]
    return "\n\n".join(parts) + "\n"


def _number(value: float) -> str:
    """Return four digits: as many as every processor agrees on."""
    text = f"{float(value) + 0.0:.4g}"
    return "0" if float(text) == 0.0 or abs(float(value)) < 1e-9 else text
