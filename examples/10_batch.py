"""Convert many drawings at once, on two processors.

Run: python examples/10_batch.py. It writes the folder painted: programs, pictures, contact-1.png and table.csv.
Run it again: nothing is converted a second time.
"""

from pathlib import Path

import brushsvg

HERE = Path(__file__).parent
LINE = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="40mm" viewBox="0 0 80 40">'
    '<path id="wave" fill="none" stroke="black" stroke-width="{}" d="M 15 20 C 30 5 50 35 65 20"/></svg>'
)


def main() -> None:
    # Items are paths, folders, patterns, or pairs of a name and an SVG document.
    items: list[str | tuple[str, str]] = [str(HERE / "robot.svg"), str(HERE / "vincent.svg")]
    items += [(f"wave-{width}", LINE.format(width)) for width in (2, 4, 30)]

    # One drawing cannot be painted: its line is wider than the brush. The others are still converted.
    done = brushsvg.batch(items, "painted", jobs=2, wide="refuse")
    for row in done.rows:
        if row.figures:
            print(f"{row.name}: overlap {row.figures.overlap:.3f}")
        else:
            print(f"{row.name}: refused: {row.text}")
    print(f"{len(done.rows)} drawings, {len(done.refused)} refused, {done.resumed} done by an earlier run")


if __name__ == "__main__":  # each process reads this file again
    main()
