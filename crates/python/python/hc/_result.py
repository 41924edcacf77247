"""What all results are: attributes that compare by value, and points with words for them."""

import html

import numpy as np


class Result:
    """Attributes from a dict. Two results are equal if all but their times are, to the last bit."""

    def __init__(self, found):
        self.__dict__.update(found)

    def __eq__(self, other):
        if type(self) is not type(other):
            return NotImplemented
        mine, theirs = _lasting(self), _lasting(other)
        return mine.keys() == theirs.keys() and all(same(mine[name], theirs[name]) for name in mine)

    __hash__ = None  # type: ignore[assignment]


class Points(Result):
    """A result with `points`, of which `is_real` says which are real, and the program's `summary`."""

    @property
    def real_points(self):
        """The real ones of `points`, ndarray of float of shape (n_real, n)."""
        return self.points[self.is_real].real.copy()

    @property
    def n_real(self):
        """How many of `points` are real."""
        return int(self.is_real.sum())

    def __repr__(self):
        return self.summary.rstrip("\n")

    def _repr_html_(self):
        return f"<pre>{html.escape(repr(self))}</pre>"


def _lasting(result):
    return {name: value for name, value in vars(result).items() if name != "seconds"}


def same(one, other):
    """Whether two values are the same; arrays in type, shape and every bit."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    if isinstance(one, (list, tuple)) and type(one) is type(other):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return False
    return bool(one == other)
