"""Write programs in a robot language of your own: this file is a post processor, and it uses itself.

Run: python examples/11_custom_post.py. It writes word.robodk, one command per line.
brushsvg checks all limits, then calls RobotPost as RoboDK does: lengths in mm, speeds in mm/s, times in ms.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import brushsvg
from brushsvg.machine.cells.cell import RoboDK

# What brushsvg calls, and the word for it in this language. Other calls, as ProgStart, write nothing.
WORDS = {"setFrame": "PAPER", "setSpeed": "SPEED", "MoveL": "LINE", "MoveC": "CIRCLE", "Pause": "WAIT"}


class RobotPost:
    LOG = ""  # text here means that the post failed, and why

    def __init__(self, name: str, robot: str, axes: int) -> None:
        self.lines = [f"NAME {name}"]

    def __getattr__(self, call: str) -> Callable[..., None]:
        return lambda *values: self.write(WORDS[call], values) if call in WORDS else None

    def write(self, word: str, values: tuple[float | list[list[float]] | None, ...]) -> None:
        """Write a word with its numbers. A pose is a matrix (4 x 4), of which the place x, y, z is written."""
        for value in values:
            numbers = [row[3] for row in value[:3]] if isinstance(value, list) else [value]
            word += "".join(f" {each:.3f}" for each in numbers if isinstance(each, float))
        self.lines.append(word)

    def RunMessage(self, text: str, is_comment: bool = False) -> None:
        self.lines.append(f"# {text}" if is_comment else f"SHOW {text}")

    def ProgSave(self, folder: str, name: str, ask: bool, show: bool) -> None:
        Path(folder, f"{name}.txt").write_text("\n".join([*self.lines, ""]), encoding="utf-8")


if __name__ == "__main__":  # brushsvg imports this file, too
    cell = replace(brushsvg.find_cell("kr6-r900"), name="mine", language="robodk", robodk=RoboDK(__file__))
    done = brushsvg.convert(Path(__file__).with_name("robot.svg"), "word.robodk", cell=cell)
    print(*done.text.splitlines()[:20], "...", sep="\n")
