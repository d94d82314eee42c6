"""Compare and show dataclasses that hold arrays."""

from __future__ import annotations

from dataclasses import fields

import numpy as np


class ArrayValue:
    """Base class of frozen dataclasses with arrays, eq=False and repr=False.

    Two values are equal if they have one class and equal entries; in arrays, NaN equals NaN. repr shows the
    shapes of arrays in place of their numbers.
    """

    def __eq__(self, other) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(_same(getattr(self, f.name), getattr(other, f.name)) for f in fields(self))

    __hash__ = None

    def __repr__(self) -> str:
        given = (f"{f.name}={_show(getattr(self, f.name))}" for f in fields(self))
        return f"<{type(self).__name__} {', '.join(given)}>"


def _same(a, b) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return np.array_equal(a, b, equal_nan=a.dtype.kind == b.dtype.kind == "f")
    return type(a) is type(b) and bool(a == b)


def _show(value) -> str:
    return f"array of shape {value.shape}" if isinstance(value, np.ndarray) and value.ndim else repr(value)
