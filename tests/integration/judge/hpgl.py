"""Run HP-GL as the manuals of HP's pen plotters say; hp2xx is a second opinion.

A unit is 0.025 mm, and the pen is up or down. IN resets everything and lifts the pen. Parameters after PU, PD
and PA are places, absolute after PA and relative after PR.

Instructions that write, scale, turn or ask count as text that acts. An unknown instruction sets the error
light.
"""

from __future__ import annotations

import math
import re

from .moves import Leg, RefusedError, Run

UNIT_MM = 0.025
DROPPED_MM_S = 10.0  # speed of a falling pen, which no program sets
NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)"
WORD = re.compile(rf'\s*(?:CO\s*"([^"]*)"|([A-Za-z]{{2}})\s*((?:{NUMBER}[\s,]*)*))\s*;?')
GREATEST = 32767  # the largest coordinate, in plotter units
FASTEST_CM_S = 127


def run_hpgl(text: str, start, down_mm: float, up_mm: float, travel_mm_s: float) -> Run:
    """Run a program in HP-GL.

    start is the place of the pen before the program. down_mm and up_mm are its heights, and travel_mm_s is
    the speed of the lifted pen.
    """
    plotter = _Plotter(start, down_mm, up_mm, travel_mm_s)
    plotter.run.acts += ["a return, which a plotter may take for the end of a text"] if "\r" in text else []
    at = 0
    try:
        while text[at:].strip():
            plotter.line = text.count("\n", 0, at + len(text[at:]) - len(text[at:].lstrip())) + 1
            if not (found := WORD.match(text, at)) or found.end() == at:
                raise RefusedError(f"line {plotter.line}: {text[at : at + 20]!r} is no instruction")
            if found[1] is not None:
                plotter.says(found[1])
            else:
                plotter.does(found[2].upper(), [float(n) for n in re.findall(NUMBER, found[3])])
                if found[3].rstrip().endswith(","):
                    plotter.run.frame.append(f"line {plotter.line}: a last comma, of which no manual speaks")
            at = found.end()
    except RefusedError as refusal:
        plotter.run.refused = str(refusal)
    if plotter.pen:
        plotter.run.frame.append(f"pen {plotter.pen} is held at the end")
    return plotter.run


class _Plotter:
    def __init__(self, start, down_mm: float, up_mm: float, travel_mm_s: float):
        self.run, self.line = Run(), 0
        self.at, self.heights = list(start), {False: up_mm, True: down_mm}
        self.travel_mm_s, self.speed_mm_s = travel_mm_s, FASTEST_CM_S * 10.0
        self.is_down, self.is_absolute, self.pen, self.has_begun = False, True, 0, False

    def says(self, words: str) -> None:
        if self.has_begun:
            self.run.titles.append((words, len(self.run.legs)))
        else:
            self.run.header.append(words)

    def does(self, word: str, values: list[float]) -> None:
        if word != "IN" and not self.has_begun:
            self.run.acts.append(f"line {self.line}: {word} before IN: scales and pens of the last job hold")
        self.has_begun = True
        if word == "IN" and not values:
            self.is_absolute, self.speed_mm_s = True, FASTEST_CM_S * 10.0
            self._lift(False)
        elif word in ("PU", "PD"):
            self._lift(word == "PD")
            self._go(values)
        elif word in ("PA", "PR"):
            self.is_absolute = word == "PA"
            self._go(values)
        elif word == "SP" and len(values) <= 1:
            pen = int(values[0]) if values else 0
            if self.is_down:
                self.run.acts.append(f"line {self.line}: the pen is changed while it is down")
            if not 0 <= pen <= 8:
                self.run.acts.append(f"line {self.line}: there is no pen {pen}")
            if pen != self.pen:
                here = tuple(self.at)
                self.run.legs.append(Leg(self.line, "stop", here, here, seconds=float(pen)))
            self.pen = pen
        elif word == "VS" and len(values) <= 1:
            cm_s = values[0] if values else FASTEST_CM_S
            if not 0 < cm_s <= FASTEST_CM_S:
                self.run.acts.append(f"line {self.line}: {cm_s:g} cm/s")
            self.speed_mm_s = 10.0 * cm_s
        else:
            self.run.acts.append(f"line {self.line}: {word} does something else")

    def _lift(self, is_down: bool) -> None:
        self.is_down = is_down
        there = [*self.at[:2], self.heights[is_down]]
        if there != self.at:
            self.run.legs.append(Leg(self.line, "jump", tuple(self.at), tuple(there), DROPPED_MM_S))
        self.at = there

    def _go(self, values: list[float]) -> None:
        if len(values) % 2:
            self.run.acts.append(f"line {self.line}: half a place")
        for x, y in zip(values[::2], values[1::2], strict=False):
            there = [UNIT_MM * x, UNIT_MM * y, self.at[2]]
            if not self.is_absolute:
                there[:2] = [a + b for a, b in zip(self.at, there[:2], strict=False)]
            if max(map(abs, there[:2])) > GREATEST * UNIT_MM or not all(map(math.isfinite, there)):
                self.run.acts.append(f"line {self.line}: a place that no plotter has")
            if not self.pen:
                self.run.acts.append(f"line {self.line}: drawn without a pen")
            kind, speed = ("feed", self.speed_mm_s) if self.is_down else ("rapid", self.travel_mm_s)
            self.run.legs.append(Leg(self.line, kind, tuple(self.at), tuple(there), speed))
            self.at = there
