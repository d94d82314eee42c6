"""Damaged geometry: readers take what is sound of it, with a notice; who did not ask for that is refused."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import Error

if TYPE_CHECKING:
    from .design import Design


def refuse_damage(design: Design) -> None:
    """Error with the first notice of geometry that is broken, as it was drawn, and was read up to there."""
    for notice in design.notices:
        if notice.damaged:
            raise Error(notice.sentence, where=notice.where, code=notice.code, advice=notice.advice)
