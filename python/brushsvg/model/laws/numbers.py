"""Arguments as arrays of numbers within their ranges.

Anything else is refused with a sentence.
"""

from __future__ import annotations

import numpy as np

from ...errors import Error

FARTHEST_MM = 1e6  # a longer way is a damaged number
DEEPEST_MM = 1000.0


def numbers(given, what: str, least: float, greatest: float) -> np.ndarray:
    """Return the given numbers as floats.

    Raises Error for values that are no numbers, masked, or outside of [least, greatest]. what: names the argument in
    the message.
    """
    rows = given if isinstance(given, (list, tuple)) else [given]
    is_masked = any(isinstance(row, np.ma.MaskedArray) for row in rows)
    try:
        array = np.ma.asarray(given) if is_masked else np.asarray(given)
    except ValueError:  # rows of different lengths
        raise Error(f"{what} is not a number or an array of numbers", code="wrong-type") from None
    if array.dtype.kind not in "iuf":
        raise Error(f"{what} is not a number or an array of numbers", code="wrong-type")
    array = array.astype(float)
    if np.ma.is_masked(array):
        sentence = f"{what} has masked entries, which are not in the range [{least:g}, {greatest:g}]: remove them"
        raise Error(sentence, value=np.nan, range=(least, greatest), code="out-of-range")
    array = np.asarray(array)
    outside = array[~((array >= least) & (array <= greatest))]
    if outside.size:
        sentence = f"{what}, {outside[0]:g}, is outside the range [{least:g}, {greatest:g}]"
        raise Error(sentence, value=float(outside[0]), range=(least, greatest), code="out-of-range")
    return array


def together(*arrays: np.ndarray) -> list[np.ndarray]:
    """Broadcast arrays against each other.

    Raises Error where their shapes do not fit.
    """
    try:
        return list(np.broadcast_arrays(*arrays))
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in arrays)
        raise Error(f"arrays of shapes {shapes} cannot be broadcast together", code="sizes-differ") from None


def frozen(array) -> np.ndarray:
    """Return a copy of an array that cannot be written to."""
    array = np.array(array)
    array.setflags(write=False)
    return array
