# Law: none; products of vectors that lie on the last axis, one row per contact.
# Covers: what loads.py, tangential.py and rolling.py share.
# Assumes: three components for cross.
"""Dot and cross products (numpy's general cross costs more than a whole contact law)."""

import numpy as np


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a . b with the last axis kept, so that it multiplies vectors."""
    return np.sum(a * b, axis=-1, keepdims=True)


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a x b."""
    return a.take(_NEXT, -1) * b.take(_LAST, -1) - a.take(_LAST, -1) * b.take(_NEXT, -1)


_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])
