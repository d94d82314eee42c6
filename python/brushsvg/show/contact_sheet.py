"""Draw contact sheets of many drawings as PNG: a small picture of each with its figures, or why it was refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from .overlap_png import write_legend
from .picture_colours import MUTED_TEXT, PAPER, REFUSED_TEXT, TEXT, WHITE
from .png_canvas import bgr, blank_canvas, encode_png, text_width, write_text

ACROSS, DOWN = 5, 6
CARD_W, PICTURE_H, WORDS_H, GAP, MARGIN, TOP = 360, 220, 64, 16, 40, 110  # px
NAME_PX, WORDS_PX, LINE_PX = 20, 16, 24


@dataclass(frozen=True)
class Card:
    """One drawing of a contact sheet.

    words: its figures, or the code of its refusal; why: the sentence of the refusal; picture: returns its picture as a
    PNG, or None for a refused drawing.
    """

    name: str
    words: str
    why: str
    picture: Callable[[], bytes] | None


def contact_sheets(cards: list[Card]) -> Iterator[bytes]:
    """Draw the pages of a contact sheet, with at most 30 cards each, as PNG bytes."""
    pages = -(-len(cards) // (ACROSS * DOWN))
    refused = sum(card.picture is None for card in cards)
    heading = f"{len(cards)} drawing{'s' * (len(cards) != 1)}" + (f", {refused} refused" if refused else "")
    for number in range(pages):
        page = cards[number * ACROSS * DOWN :][: ACROSS * DOWN]
        yield _draw_sheet(page, heading + (f", page {number + 1} of {pages}" if pages > 1 else ""))


def _draw_sheet(cards: list[Card], heading: str) -> bytes:
    down = -(-len(cards) // ACROSS)
    card_h = PICTURE_H + WORDS_H
    width = 2 * MARGIN + ACROSS * CARD_W + (ACROSS - 1) * GAP
    image = blank_canvas((TOP + down * (card_h + GAP) + MARGIN - GAP, width), PAPER)
    write_text(image, heading, (MARGIN, 56), 30, 600, TEXT)
    write_legend(image, MARGIN, 74, 16)
    for k, card in enumerate(cards):
        x = MARGIN + k % ACROSS * (CARD_W + GAP)
        y = TOP + k // ACROSS * (card_h + GAP)
        part = image[y : y + card_h, x : x + CARD_W]
        part[:] = bgr(WHITE)
        if card.picture is None:
            _write_wrapped(part, card.why)
        else:
            _place_picture(part[:PICTURE_H], card.picture())
        words_y = PICTURE_H + NAME_PX
        write_text(part, _shorten_to_fit(card.name, NAME_PX, 600), (12, words_y), NAME_PX, 600, TEXT)
        colour = REFUSED_TEXT if card.picture is None else MUTED_TEXT
        write_text(part, card.words, (12, words_y + LINE_PX), WORDS_PX, 400, colour)
    return encode_png(image)


def _place_picture(part: np.ndarray, png: bytes) -> None:
    """Draw a PNG into part, centred and as large as it fits."""
    picture = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
    scale = min(part.shape[0] / picture.shape[0], part.shape[1] / picture.shape[1])
    size = [max(round(side * scale), 1) for side in picture.shape[1::-1]]
    small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)
    y, x = (part.shape[0] - small.shape[0]) // 2, (part.shape[1] - small.shape[1]) // 2
    part[y : y + small.shape[0], x : x + small.shape[1]] = small


def _write_wrapped(part: np.ndarray, text: str) -> None:
    """Write a sentence, wrapped at spaces and cut off where there is no room."""
    lines, rest = [], text.split()
    while rest:
        line = rest.pop(0)
        while rest and text_width(f"{line} {rest[0]}", WORDS_PX, 400) <= CARD_W - 24:
            line += f" {rest.pop(0)}"
        lines.append(_shorten_to_fit(line, WORDS_PX, 400))
    most = (PICTURE_H - 12) // LINE_PX
    if len(lines) > most:
        lines[most - 1 :] = [_shorten_to_fit(f"{lines[most - 1]} ...", WORDS_PX, 400)]
    for number, line in enumerate(lines):
        write_text(part, line, (12, (number + 1) * LINE_PX + 6), WORDS_PX, 400, MUTED_TEXT)


def _shorten_to_fit(text: str, size: int, weight: int) -> str:
    short = text
    while short and text_width(short, size, weight) > CARD_W - 24:
        text = text[:-1]
        short = f"{text}..."
    return short
