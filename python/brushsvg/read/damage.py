"""Refuse drawings with damaged geometry.

Readers keep the undamaged part and add a notice. Only callers that ask for lenient reading accept such a drawing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import Error

if TYPE_CHECKING:
    from .design import Design


def refuse_damage(design: Design) -> None:
    """Raise Error with the first notice about damaged geometry, if there is one."""
    for notice in design.notices:
        if notice.damaged:
            raise Error(notice.sentence, where=notice.where, code=notice.code, advice=notice.advice)
