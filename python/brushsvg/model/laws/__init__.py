"""The brush's laws, one function each.

Lemma 1, Theorems 1 to 4, the loose rule, and laws fitted to measurements. Numbers in brackets are equations of the
article: docs/reference/equations.md, which also says where the print is wrong. Lengths are in mm, angles in rad.
Where a shape is given as (...), arguments are numbers or arrays that broadcast as in numpy.
"""

from ..._core import LawFit, Profile
from .angles import FromAngles, from_angles, tip_direction
from .bristle import Bristle, bristle, bristle_of_article
from .fitted import fit_law
from .motion import (
    Followed,
    alpha_after,
    alpha_after_turn,
    alpha_on_ramp,
    contact_offset,
    follow,
    tip_offset,
)

__all__ = [
    "Bristle",
    "Followed",
    "FromAngles",
    "LawFit",
    "Profile",
    "alpha_after",
    "alpha_after_turn",
    "alpha_on_ramp",
    "bristle",
    "bristle_of_article",
    "contact_offset",
    "fit_law",
    "follow",
    "from_angles",
    "tip_direction",
    "tip_offset",
]
