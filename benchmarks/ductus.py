"""Count how many of 62 glyphs of a font are painted in the order of handwriting.

The judge is KanjiVG, which also has the Latin letters and digits of Japanese schools (CC BY-SA 3.0; `pip
install kanjivg`). The boxes of a glyph and its writing are aligned. Each place of a painted stroke gets the
time at which the nearest place is written. A stroke runs right if this time grows along most of it. Two
strokes are in the right order if the first one has the smaller middle time.

KanjiVG's letters have no serifs, so the program separates serifs. A serif is shorter than 0.7 of another
stroke, its stem, and shorter than seven half widths of the stem. The stem begins or ends on the serif. Main
strokes are compared with KanjiVG. A serif must follow its stem. Dots are up to twice as long as wide and have
no direction. Other forms (a, g, 1, 4, 7 of many fonts) can be judged wrongly: look at the printed letters
before you trust the result.

--characters needs the folder of npm's hanzi-writer-data. The program uses 200 of its characters that have as
many strokes in KanjiVG, each drawn as one shape. Their order is compared with both sources. Japanese and
Chinese schools write some characters differently, so even the order of hanzi-writer-data has only 0.993 of
KanjiVG's pairs, and 0.78 of its characters.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import numpy as np
from scipy.optimize import linear_sum_assignment
from svgpathtools import parse_path

from brushsvg import _core
from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg
from brushsvg.strokes.extraction import strokes

LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
DENSE = np.linspace(0.0, 1.0, 60)
SERIF, SERIF_HALVES = 0.7, 7.0
DOT = 2.0
CHARACTERS, SEED = 200, 20260
OWN_SHARE = 0.7  # a painted stroke is a stroke of the reference if this share of it is nearest to it


@cache
def kanjivg_folder() -> Path:
    file = next(each for each in importlib.metadata.files("kanjivg") if each.as_posix().startswith("kanji/"))
    return Path(file.locate()).parent


def written(letter: str) -> list[np.ndarray]:
    """Return lines (n, 2) in the order of writing, y up.

    The list is empty if KanjiVG lacks the letter.
    """
    file = kanjivg_folder() / f"{ord(letter):05x}.svg"
    if not file.exists():
        return []
    paths = [each.get("d") for each in ET.parse(file).iter("{http://www.w3.org/2000/svg}path")]
    points = [np.array([parse_path(d).point(t) for t in DENSE]) for d in paths]
    return [np.column_stack([each.real, -each.imag]) for each in points]


def evenly(line: np.ndarray) -> np.ndarray:
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = DENSE * along[-1]
    return np.column_stack([np.interp(at, along, line[:, k]) for k in (0, 1)])


def boxed(lines: list[np.ndarray]) -> list[np.ndarray]:
    every = np.vstack(lines)
    low, size = every.min(axis=0), np.ptp(every, axis=0)
    return [(line - low) / np.maximum(size, 0.25 * size.max()) for line in lines]


def judged(painted: list[np.ndarray], reference: list[np.ndarray]) -> tuple[list[bool], list[bool]]:
    """Judge direction and order.

    Return whether each stroke runs right, and whether each pair of strokes is in the right order.
    """
    runs, middles, _ = timed(boxed([evenly(line) for line in painted]), boxed([evenly(line) for line in reference]))
    return runs, followed(middles)


def followed(middles: list[float]) -> list[bool]:
    return [middles[i] <= middles[k] + 0.05 for k in range(len(middles)) for i in range(k)]


def timed(painted: list[np.ndarray], reference: list[np.ndarray]) -> tuple[list[bool], list[float], list[np.ndarray]]:
    """Compare each stroke with the times of the reference.

    Return for each stroke whether it runs right, its middle time, and the share of its places that are
    nearest to each reference stroke. All lines have len(DENSE) places, in one frame of size 1.
    """
    places = np.vstack(reference)
    headings = np.vstack([np.gradient(line, axis=0) for line in reference])
    headings /= np.maximum(np.hypot(*headings.T), 1e-9)[:, None]
    numbers = np.repeat(np.arange(len(reference)), len(DENSE))
    times = numbers + np.tile(DENSE, len(reference))
    runs, middles, shares = [], [], []
    for line in painted:
        heading = np.gradient(line, axis=0)
        heading /= np.maximum(np.hypot(*heading.T), 1e-9)[:, None]
        far = np.hypot(*np.moveaxis(line[:, None] - places[None], 2, 0))
        # increase the distance of crossing lines, which come too near
        across = 1.0 - np.abs(heading @ headings.T)
        nearest = np.argmin(far + 0.3 * across, axis=1)
        runs.append(bool(np.sum(np.sum(heading * headings[nearest], axis=1)) > 0))
        middles.append(float(np.median(times[nearest])))
        shares.append(np.bincount(numbers[nearest], minlength=len(reference)) / len(nearest))
    return runs, middles, shares


def lengths_of(lines: list[np.ndarray]) -> list[float]:
    return [float(np.hypot(*np.diff(line[:, :2], axis=0).T).sum()) for line in lines]


def serifs(lines: list[np.ndarray], halves: list[float]) -> dict[int, int]:
    """Return the index of the stem of each serif among lines (n, 2) with half widths.

    The stem is the longest line that begins or ends on the serif.
    """
    lengths = lengths_of(lines)
    found = {}
    for k, line in enumerate(lines):
        for stem in np.argsort(lengths)[::-1].tolist():
            near = min(np.hypot(*(evenly(line) - end).T).min() for end in lines[stem][[0, -1]])
            is_short = lengths[k] < min(SERIF * lengths[stem], SERIF_HALVES * halves[stem])
            if is_short and near < halves[k] + 0.5 * halves[stem]:
                found[k] = stem
                break
    return found


def numbers_in_kanjivg(outlined: list[np.ndarray], reference: list[np.ndarray]) -> np.ndarray:
    """Match each stroke of hanzi-writer-data with the nearest of KanjiVG, one to one."""
    ones, others = boxed([evenly(line) for line in outlined]), boxed(reference)

    def far(a: np.ndarray, b: np.ndarray) -> float:
        return float(np.hypot(*(a - b).T).mean())

    return linear_sum_assignment([[min(far(a, b), 0.1 + far(a, b[::-1])) for b in others] for a in ones])[1]


def are_found_right(shares: list[np.ndarray]) -> bool:
    """Return whether painted strokes and strokes of the reference match one to one."""
    owners = [int(np.argmax(each)) for each in shares]
    one_each = sorted(owners) == list(range(len(shares[0])))
    return one_each and min(max(each) for each in shares) > OWN_SHARE


def characters(folder: Path, script: str) -> str:
    """Return a report on the order of characters that are drawn as one shape.

    The order is compared with KanjiVG and with the characters' own source. Strokes are matched with the
    middle lines of hanzi-writer-data, which fit the outlines, and these lines get the numbers of KanjiVG. So
    differences between the two drawings cannot swap neighbouring strokes.
    """
    files = sorted(file for file in folder.glob("*.json") if len(file.stem) == 1)
    rows = []
    for k in np.random.default_rng(SEED).permutation(len(files)):
        drawn = json.loads(files[k].read_text(encoding="utf-8"))
        reference = written(files[k].stem)
        if len(reference) != len(drawn["strokes"]):
            continue
        document = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1024 1024" width="100mm" height="100mm">'
        document += f'<path transform="matrix(1 0 0 -1 0 900)" d="{" ".join(drawn["strokes"])}"/></svg>'
        found, _ = strokes(read_svg(document.encode()), script=script)
        lines = [evenly(np.asarray(_core.flatten(each, 0.05))[:, :2]) / 100 for each in found]
        medians = [(np.array(line) + np.array([0, 124])) / 1024 for line in drawn["medians"]]
        numbers = numbers_in_kanjivg(medians, reference)
        own = [evenly(line) for line in medians]
        for source, order in (("KanjiVG", np.argsort(numbers)), ("hanzi-writer-data", range(len(own)))):
            runs, middles, shares = timed(lines, [own[i] for i in order])
            rows.append((source, are_found_right(shares), runs, followed(middles)))
        if len(rows) == 2 * CHARACTERS:
            break
    return "\n".join(
        summary(f"{source}, {title}", [row[2:] for row in rows if row[0] == source and row[1] in kinds])
        for source in ("KanjiVG", "hanzi-writer-data")
        for title, kinds in (("all", (True, False)), ("strokes found right", (True,)), ("others", (False,)))
    )


def summary(title: str, rows: list[tuple[list[bool], list[bool]]]) -> str:
    runs, pairs = (np.concatenate([row[k] for row in rows]) for k in (0, 1))
    ordered = np.mean([all(row[1]) for row in rows])
    faultless = np.mean([all(row[0]) and all(row[1]) for row in rows])
    return (
        f"{title}, {len(rows)} characters: runs {runs.mean():.4f}, pairs {pairs.mean():.4f} of {len(pairs)}, "
        f"in order {ordered:.3f}, without a fault {faultless:.3f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fonts", nargs="*", type=Path)
    parser.add_argument("--characters", type=Path, metavar="FOLDER")
    parser.add_argument("--script", default="cjk", help="of the characters; auto: as in a drawing of unknown script")
    parser.add_argument("--size", type=float, default=50.0, help="mm to the em")
    options = parser.parse_args()
    if options.characters:
        print(characters(options.characters, options.script))
    if not options.fonts:
        return
    print(f"{'font':<28} {'glyphs':>7} {'runs':>10} {'pairs':>10} {'serifs':>8}   not as written")
    for font in options.fonts:
        right, runs, pairs, behind, wrong = 0, [], [], [], []
        for letter in LETTERS:
            document, _ = text_svg(letter, font.read_bytes(), size_mm=options.size)
            found, _ = strokes(read_svg(document.encode()))
            flat = [np.asarray(_core.flatten(each, 0.05)) for each in found]
            lines = [line[:, :2] for line in flat]
            halves = [max(half for _, half in each.half_width) for each in found]
            apart = serifs(lines, halves)
            main_ones = [k for k in range(len(lines)) if k not in apart]
            running, following = judged([lines[k] for k in main_ones], written(letter))
            long = lengths_of(lines)
            running = [ok or long[k] < DOT * 2 * halves[k] for k, ok in zip(main_ones, running, strict=True)]
            behind += [stem < serif for serif, stem in apart.items()]
            runs += running
            pairs += following
            if all(running) and all(following):
                right += 1
            else:
                wrong.append(letter)
        shares = [f"{sum(each)}/{len(each)}" for each in (runs, pairs, behind)]
        print(
            f"{font.stem[:28]:<28} {right:>4}/62 {shares[0]:>10} {shares[1]:>10} {shares[2]:>8}   {' '.join(wrong)}",
            flush=True,
        )


if __name__ == "__main__":
    main()
