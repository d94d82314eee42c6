"""Fit the weights of writing order (stroke_order.json), and print their score.

    OMP_NUM_THREADS=1 python benchmarks/fit_stroke_order.py FOLDER -o stroke_order.json

FOLDER is where npm puts PACKAGES. Missing packages are fetched.

Characters come from hanzi-writer-data (npm; stroke order of Make Me a Hanzi). Some characters are drawn as
one shape each, so that brushsvg joins and splits their strokes. The others are given by their middle lines.
The 200 characters that `ductus.py` judges by KanjiVG are left out. Apart from KanjiVG, which is the judge, no
registry has the stroke order of Latin letters. So LETTERS is a table of our own. It is aligned with the
letters of each font. Letters are combined to words of two to four letters. The fonts that
`docs/evidence/letters.md` judges are left out.

The fit maximises the probability of the next stroke, given those that are written (see stroke_order.py), by
Adam. Its seed is fixed. Another processor or library of linear algebra may round differently and find
slightly other weights.

The command above wrote stroke_order.json. A second run in a new folder gave an identical file. A run needs
about 15 minutes on one processor.
"""

from __future__ import annotations

import argparse
import importlib
import json
import subprocess
import time
from pathlib import Path

import numpy as np
from ductus import CHARACTERS, SEED, boxed, evenly, kanjivg_folder, lengths_of, serifs, timed

from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg
from brushsvg.strokes.skeleton.stroke_order import pair_features, search_order

shapes = importlib.import_module("brushsvg.strokes.skeleton.shape_to_strokes")
extraction = importlib.import_module("brushsvg.strokes.extraction")

# Strokes of letters as we write them: lines of places x,y in percent of the letter's box, y up.
Sample = tuple[list[np.ndarray], float]  # strokes in order of writing, and the script flag

LETTERS = {
    "A": "50,100 0,0|50,100 100,0|20,35 80,35",
    "B": "5,100 5,0|5,98 60,97 85,78 60,53 10,52|50,52 98,27 60,2 5,2",
    "C": "95,85 55,100 3,50 55,0 95,15",
    "D": "5,100 5,0|5,98 50,97 97,50 50,3 5,2",
    "E": "5,100 5,0|5,97 100,97|5,52 80,52|5,3 100,3",
    "F": "5,100 5,0|5,97 100,97|5,50 80,50",
    "G": "93,85 55,100 3,50 55,0 90,15|60,45 95,45 95,0",
    "H": "5,100 5,0|95,100 95,0|5,52 95,52",
    "I": "50,100 50,0",
    "J": "85,100 85,30 45,0 3,25",
    "K": "5,100 5,0|95,100 5,38|35,60 98,0",
    "L": "5,100 5,0|5,3 100,3",
    "M": "5,100 5,0|5,100 50,5|95,100 50,5|95,100 95,0",
    "N": "5,100 5,0|5,100 95,0|95,100 95,0",
    "O": "50,97 3,50 50,3 97,50 50,97",
    "P": "5,100 5,0|5,97 65,97 95,72 65,45 5,45",
    "Q": "50,97 3,55 50,8 97,55 50,97|60,30 98,0",
    "R": "5,100 5,0|5,97 65,97 90,75 65,50 5,50|50,50 98,0",
    "S": "92,85 50,98 8,75 50,52 95,25 50,2 5,15",
    "T": "0,97 100,97|50,100 50,0",
    "U": "5,100 5,35 50,3 95,35 95,100",
    "V": "3,100 50,0|97,100 50,0",
    "W": "2,100 26,0|50,95 26,0|50,95 74,0|98,100 74,0",
    "X": "3,100 97,0|97,100 3,0",
    "Y": "3,100 50,45|97,100 50,45|50,45 50,0",
    "Z": "5,97 95,97 5,3 100,3",
    "a": "88,85 50,97 5,50 45,3 88,30|92,100 92,0",
    "b": "7,100 7,0|7,50 50,63 95,33 50,2 7,12",
    "c": "93,80 55,98 4,50 55,2 93,18",
    "d": "92,55 50,63 5,32 48,2 92,12|93,100 93,0",
    "e": "6,52 95,52 88,80 50,97 5,50 50,3 93,20",
    "f": "95,93 65,97 42,75 42,0|3,68 85,68",
    "g": "90,90 50,98 5,65 45,33 90,45|92,100 92,20 50,2 6,12",
    "h": "7,100 7,0|7,45 55,65 93,45 93,0",
    "i": "50,68 50,0|50,92 50,100",
    "j": "70,72 70,20 40,2 5,5|70,92 70,100",
    "k": "8,100 8,0|90,65 10,28|40,42 97,0",
    "l": "50,100 50,0",
    "m": "4,100 4,0|4,70 30,97 50,70 50,0|50,70 77,97 96,70 96,0",
    "n": "7,100 7,0|7,65 55,97 93,65 93,0",
    "o": "50,97 4,50 50,3 96,50 50,97",
    "p": "7,97 7,0|7,90 50,98 95,65 50,33 7,45",
    "q": "92,90 50,98 5,65 48,33 92,45|93,98 93,0",
    "r": "12,100 12,0|12,60 50,92 97,92",
    "s": "90,82 50,97 8,75 50,50 93,25 50,3 5,15",
    "t": "40,100 40,25 65,2 95,6|3,73 95,73",
    "u": "7,100 7,35 45,3 90,35|93,100 93,0",
    "v": "3,100 50,0|97,100 50,0",
    "w": "2,100 26,0|50,95 26,0|50,95 74,0|98,100 74,0",
    "x": "3,100 97,0|97,100 3,0",
    "y": "3,100 50,32|97,100 45,15 5,2",
    "z": "5,97 95,97 5,3 100,3",
    "0": "50,97 4,50 50,3 96,50 50,97",
    "1": "5,80 60,97|60,100 60,0",
    "2": "5,78 50,97 90,72 5,5|5,3 100,3",
    "3": "6,85 50,98 90,75 40,53|40,53 95,27 50,2 4,15",
    "4": "68,100 3,28|3,25 100,25|72,100 72,0",
    "5": "15,97 12,52|12,52 55,62 95,32 50,2 4,12|15,97 92,97",
    "6": "85,95 30,75 5,30 50,2 95,32 50,62 8,35",
    "7": "4,97 95,97 35,0",
    "8": "88,80 50,98 10,77 90,27 50,2 8,27 90,77",
    "9": "93,65 50,37 5,68 50,98 92,65 70,25 15,4",
    "é": "6,36 95,36 88,56 50,68 5,35 50,3 93,14|75,100 45,78",
    "ü": "7,68 7,24 45,3 90,24|93,68 93,0|25,95 27,95|75,95 77,95",
    "å": "88,58 50,66 5,34 45,3 88,20|92,68 92,0|50,98 35,87 50,76 65,87 50,98",
    "!": "50,100 50,30|50,8 50,0",
    "?": "8,80 50,98 92,75 48,30|48,8 48,0",
    "+": "0,50 100,50|50,100 50,0",
}
SERIF_SHARE = 0.45  # share of a letter's box: a longer stroke is not a serif
OTHER_FORM = 0.24  # mean distance between a letter and its table, in boxes; above this, the form differs
SIZE = np.array([28.0, 40.0]) / 100  # mm per percent: the letters of the table themselves
LETTER_COPIES, WORDS_PER_FONT = 5, 110
# size of a batch, hidden units, and the share of samples without a known script
BATCH, HIDDEN, UNKNOWN_SHARE = 32, 64, 0.25
LEARNING_RATE, DECAY = 6e-3, 2e-5
KEPT_BACK = 300  # characters drawn as one shape that are not in the fit; we used them to make choices
FAMILIES = """bree-serif courgette crimson-text dancing-script jost kalam libre-baskerville merriweather montserrat
nunito pacifico patrick-hand playfair-display poppins pt-serif roboto roboto-slab satisfy source-serif-4 zilla-slab"""
VERSIONS = {"source-serif-4": "5.3.1"}  # all other fonts: 5.3.0
PACKAGES = [
    "hanzi-writer-data@2.0.1",
    *(f"@fontsource/{family}@{VERSIONS.get(family, '5.3.0')}" for family in FAMILIES.split()),
]
SOURCE = (
    "fitted by benchmarks/fit_stroke_order.py to hanzi-writer-data 2.0.1 (npm; stroke order of Make Me a Hanzi) and \
to a table of letters of ours; no data of either is in here"
)


def fonts(modules: Path) -> list[bytes]:
    """Return the fonts of FAMILIES: regular, and bold if it exists."""
    files = (
        modules / "@fontsource" / family / "files" / f"{family}-latin-{weight}-normal.woff"
        for family in FAMILIES.split()
        for weight in (400, 700)
    )
    return [file.read_bytes() for file in files if file.exists()]


def found_lines(document: str, script: str) -> list[np.ndarray]:
    """Return the middle lines (k, 3) of a drawing's strokes, in their direction."""
    kept = []
    made = shapes._find_area_strokes

    def keep(*arguments):
        found = made(*arguments)
        kept.extend(line for line, _ in found)
        return found

    shapes._find_area_strokes = keep
    try:
        extraction.strokes(read_svg(document.encode()), script=script)
    finally:
        shapes._find_area_strokes = made
    return kept


def characters(folder: Path, count: int) -> tuple[list[Sample], list[Sample]]:
    """Return the strokes of characters in order.

    The first list holds characters drawn as one shape, the second all others by their middle lines. The
    characters that ductus.py judges are in neither.
    """
    files = sorted(file for file in folder.glob("*.json") if len(file.stem) == 1)
    judged, merged, plain = 0, [], []
    for k in np.random.default_rng(SEED).permutation(len(files)):
        drawn = json.loads(files[k].read_text(encoding="utf-8"))
        if judged < CHARACTERS and strokes_in_kanjivg(files[k].stem) == len(drawn["strokes"]):
            judged += 1
            continue
        medians = [(np.array(line) + np.array([0, 124])) * 100 / 1024 for line in drawn["medians"]]
        if len(merged) < count:
            path = f'<path transform="matrix(1 0 0 -1 0 900)" d="{" ".join(drawn["strokes"])}"/>'
            size = 'viewBox="0 0 1024 1024" width="100mm" height="100mm"'
            lines = found_lines(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{path}</svg>', "cjk")
            reference = [evenly(line) / 100 for line in medians]
            _, middles, _ = timed([evenly(line[:, :2]) / 100 for line in lines], reference)
            merged.append(([lines[i][:, :2] for i in np.argsort(middles, kind="stable")], 1.0))
        else:
            plain.append((medians, 1.0))
    return [x for x in merged if len(x[0]) > 1], [x for x in plain if len(x[0]) > 1]


def strokes_in_kanjivg(character: str) -> int:
    file = kanjivg_folder() / f"{ord(character):05x}.svg"
    return file.read_text(encoding="utf-8").count("<path ") if file.exists() else 0


def letters(font: bytes) -> dict[str, list[np.ndarray]]:
    """Return the lines of each letter in the order of its table.

    Letters of another form are left out.
    """
    result = {}
    for letter, table in LETTERS.items():
        document, _ = text_svg(letter, font, size_mm=50.0)
        lines = found_lines(document, "latin")
        flat = [line[:, :2] for line in lines if len(line) > 1]
        if not flat:
            continue
        box = np.ptp(np.vstack(flat), axis=0).max()
        known = serifs(flat, [line[:, 2].max() for line in lines if len(line) > 1])
        known = {k: stem for k, stem in known.items() if lengths_of([flat[k]])[0] < SERIF_SHARE * box}
        own = [k for k in range(len(flat)) if k not in known]
        reference, main = (
            boxed([evenly(each) for each in table_strokes(table)]),
            boxed([evenly(flat[k]) for k in own]),
        )
        every, here = np.vstack(reference), np.vstack(main)
        off = np.hypot(*np.moveaxis(every[:, None] - here[None], 2, 0))
        if off.min(axis=0).mean() + off.min(axis=1).mean() > OTHER_FORM:
            continue
        runs, _, _ = timed(main, reference)
        main = [line if run else line[::-1] for line, run in zip(main, runs, strict=True)]
        # the beginning of a stroke decides its order
        begins = [evenly(line[: 2 * len(line) // 5]) for line in main]
        time = dict(zip(own, timed(begins, reference)[1], strict=True))
        for k in known:
            leftmost_top = float(flat[k][:, 1].mean() - flat[k][:, 0].mean())
            time[k] = time.get(known[k], len(reference)) + 1e-3 - 1e-5 * leftmost_top
        result[letter] = [flat[k] for k in sorted(time, key=time.__getitem__)]
    return result


def table_strokes(table: str) -> list[np.ndarray]:
    return [np.array([[float(v) for v in p.split(",")] for p in s.split()]) for s in table.split("|")]


def words(made: dict[str, list[np.ndarray]], rng) -> list[Sample]:
    """Return the strokes of letters, and of words of two to four letters."""
    several = {letter: lines for letter, lines in made.items() if len(lines) > 1}
    result = [(stretched(lines, rng), -1.0) for lines in several.values() for _ in range(LETTER_COPIES)]
    names = list(made)
    for _ in range(WORDS_PER_FONT):
        at, lines = 0.0, []
        for k in rng.integers(0, len(names), rng.integers(2, 5)):
            letter = stretched(made[names[k]], rng)
            left, right = np.vstack(letter)[:, 0].min(), np.vstack(letter)[:, 0].max()
            lines += [line + np.array([at - left, 0.0]) for line in letter]
            at += right - left + rng.uniform(2, 10)
        if len(lines) > 1:
            result.append((lines, -1.0))
    return result


def stretched(lines: list[np.ndarray], rng) -> list[np.ndarray]:
    """Return lines stretched and slanted at random."""
    stretch, slant = rng.uniform(0.75, 1.3), rng.uniform(-0.1, 0.2)
    return [line @ np.array([[stretch, 0.0], [slant, 1.0]]) for line in lines]


def gradient(output: np.ndarray, count: int) -> np.ndarray:
    """Return the derivative of the loss by the network's output (count^2, 2).

    The loss is -log of the probability of the order 0, 1, ...
    """
    before, follows = np.moveaxis(output.reshape(count, count, 2), 2, 0)
    margin = before - before.T
    cost = -np.logaddexp(0, -margin)
    np.fill_diagonal(cost, 0)
    score = np.cumsum(cost[:, ::-1], axis=1)[:, ::-1].T.copy()  # step, candidate
    score[1:] += follows[:-1]
    score[np.tril(np.ones((count, count), bool), -1)] = -1e9  # this stroke is already written
    chance = np.exp(score - score.max(axis=1, keepdims=True))
    chance /= chance.sum(axis=1, keepdims=True)
    by_score = chance - np.eye(count, dtype=output.dtype)
    by_margin = np.cumsum(by_score.T, axis=1) / (1 + np.exp(np.clip(margin, -40, 40)))
    np.fill_diagonal(by_margin, 0)
    by_follows = np.vstack([by_score[1:], np.zeros(count)])
    return np.stack([(by_margin - by_margin.T).ravel(), by_follows.ravel()], axis=1)


def fit(samples: list[np.ndarray], epochs: int, rng: np.random.Generator) -> list[np.ndarray]:
    """Return the weights: hidden, bias, output.

    samples are features (n, n, f) in single precision.
    """
    count = samples[0].shape[2]
    scale = np.concatenate([x.reshape(-1, count) for x in samples[::7]]).std(axis=0) + 1e-3
    scale[-1] = 1.0
    samples = [x.reshape(-1, count) / scale for x in samples]
    weights = [rng.normal(0, size[0] ** -0.5, size) for size in ((count, HIDDEN), (HIDDEN, 2))]
    weights.insert(1, np.zeros(HIDDEN))
    weights = [each.astype(np.float32) for each in weights]
    mean, square = [0 * each for each in weights], [0 * each for each in weights]
    steps, step = epochs * -(-len(samples) // BATCH), 0
    for _ in range(epochs):
        for batch in np.split(rng.permutation(len(samples)), range(BATCH, len(samples), BATCH)):
            sizes = [len(samples[k]) for k in batch]
            features = np.concatenate([samples[k] for k in batch])
            features[:, -1] *= np.repeat(rng.random(len(batch)) > UNKNOWN_SHARE, sizes)
            hidden = np.tanh(features @ weights[0] + weights[1])
            parts = np.split(hidden @ weights[2], np.cumsum(sizes)[:-1])
            by_output = np.concatenate([gradient(part, round(len(part) ** 0.5)) for part in parts])
            by_output = (by_output / len(batch)).astype(np.float32)
            by_hidden = (by_output @ weights[2].T) * (1 - hidden**2)
            step += 1
            rate = np.float32(LEARNING_RATE * 0.5 * (1 + np.cos(np.pi * step / steps)))
            for k, slope in enumerate((features.T @ by_hidden, by_hidden.sum(axis=0), hidden.T @ by_output)):
                slope = slope + np.float32(DECAY) * weights[k]
                mean[k] += np.float32(0.1) * (slope - mean[k])
                square[k] += np.float32(0.001) * (slope**2 - square[k])
                root = np.sqrt(square[k] / np.float32(1 - 0.999**step)) + np.float32(1e-8)
                weights[k] = weights[k] - rate * mean[k] / np.float32(1 - 0.9**step) / root
    return [weights[0] / scale[:, None], *weights[1:]]


def in_order(weights: list[np.ndarray], samples: list[np.ndarray]) -> tuple[float, float]:
    """Return the share of pairs in order, and of samples completely in order."""
    pairs, whole = [], []
    for sample in samples:
        before, follows = np.moveaxis(np.tanh(sample @ weights[0] + weights[1]) @ weights[2], 2, 0)
        precedence = -np.logaddexp(0.0, before.T - before)
        np.fill_diagonal(precedence, 0)
        place = np.argsort(search_order(precedence, follows))
        right = [place[i] < place[k] for k in range(len(place)) for i in range(k)]
        pairs += right
        whole.append(all(right))
    return float(np.mean(pairs)), float(np.mean(whole))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="where npm puts PACKAGES")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--count", type=int, default=3600, help="characters drawn as one shape")
    parser.add_argument("--epochs", type=int, default=40)
    options = parser.parse_args()
    rng = np.random.default_rng(0)
    modules = options.folder / "node_modules"
    if not all((modules / package.rsplit("@", 1)[0]).exists() for package in PACKAGES):
        subprocess.run(["npm", "install", "--prefix", options.folder, "--no-save", *PACKAGES], check=True)
    began = time.monotonic()
    merged, plain = characters(modules / "hanzi-writer-data", options.count)
    table = {letter: [line * SIZE for line in table_strokes(lines)] for letter, lines in LETTERS.items()}
    lettering = [*(letters(font) for font in fonts(modules)), table]
    latin = [sample for each in lettering for sample in words(each, rng)]
    print(f"{len(merged)} characters drawn as one shape, {len(plain)} by middle lines, {len(latin)} words and letters")
    known, others, latin = (
        [pair_features(*sample).astype(np.float32) for sample in samples] for samples in (merged, plain, latin)
    )
    print(f"read in {time.monotonic() - began:.0f} s", flush=True)
    weights = fit([*known[KEPT_BACK:], *others, *latin], options.epochs, rng)
    pairs, whole = in_order(weights, known[:KEPT_BACK])
    print(f"{pairs:.4f} of the pairs of {KEPT_BACK} characters kept back are in order, {whole:.3f} of the characters")
    print(f"done in {time.monotonic() - began:.0f} s")
    table = {"source": SOURCE}
    for name, each in zip(("hidden", "bias", "output"), weights, strict=True):
        table[name] = json.loads(json.dumps(each.tolist()), parse_float=lambda text: float(f"{float(text):.4g}"))
    text = json.dumps(table).replace("], [", "],\n[").replace(', "', ',\n"')
    options.output.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
