"""Arguments as arrays of numbers within their ranges; anything else is refused in a sentence."""

from __future__ import annotations

import numpy as np

from ...errors import Error

FARTHEST_MM = 1e6  # a longer way is damage
DEEPEST_MM = 1000.0


def numbers(given, what: str, least: float, greatest: float) -> np.ndarray:
    """The same as floats. Error for what is no number, or outside of [least, greatest]."""
    try:
        found = np.asarray(given)
    except ValueError:  # rows of different lengths
        raise Error(f"{what} is no number and no array of them", code="wrong-type") from None
    if found.dtype.kind not in "iuf":
        raise Error(f"{what} is no number and no array of them", code="wrong-type")
    found = found.astype(float)
    outside = found[~((found >= least) & (found <= greatest))]
    if outside.size:
        raise Error(
            f"{what}, {outside[0]:g}, is outside the range [{least:g}, {greatest:g}]",
            value=float(outside[0]),
            range=(least, greatest),
            code="out-of-range",
        )
    return found


def together(*arrays: np.ndarray) -> list[np.ndarray]:
    """Broadcast against each other. Error where their shapes do not fit."""
    try:
        return list(np.broadcast_arrays(*arrays))
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in arrays)
        raise Error(f"arrays of shapes {shapes} do not belong together", code="sizes-differ") from None


def frozen(array) -> np.ndarray:
    """An array of its own that cannot be written to."""
    array = np.array(array)
    array.setflags(write=False)
    return array
