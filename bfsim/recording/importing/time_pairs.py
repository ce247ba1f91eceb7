"""Pair the pictures of two cameras by their time stamps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Times = NDArray[np.int64]


def rising(times_ns: Times) -> NDArray[np.intp]:
    """Return the indices of the time stamps that are later than all before."""
    before = np.maximum.accumulate(times_ns)[:-1]
    return np.flatnonzero(np.concatenate([[True], times_ns[1:] > before])) if times_ns.size else np.arange(0)


def period_ns(times_ns: Times) -> float | None:
    """Return the median time between two pictures; None for fewer than two."""
    return float(np.median(np.diff(times_ns))) if times_ns.size > 1 else None


def nearest_pairs(
    left_ns: Times, right_ns: Times, slop_ns: float
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the indices of left and right pictures that are each other's nearest, at most `slop_ns` apart.

    Both lists of time stamps must rise. No picture is in two pairs, and pairs are in order. If two pictures are equally
    near, a left picture takes the later one and a right picture the earlier one, so that cameras half a period apart
    have pairs.
    """
    if not (left_ns.size and right_ns.size):
        return np.arange(0), np.arange(0)
    right = _nearest(left_ns, right_ns, late=True)
    left = np.arange(left_ns.size)
    is_pair = (_nearest(right_ns, left_ns, late=False)[right] == left) & (
        np.abs(left_ns - right_ns[right]) <= slop_ns
    )
    return left[is_pair], right[is_pair]


def _nearest(times_ns: Times, others_ns: Times, *, late: bool) -> NDArray[np.intp]:
    """Return the index of the nearest of the others for each time; of two equally near ones the later, if `late`."""
    after = np.clip(np.searchsorted(others_ns, times_ns), 0, others_ns.size - 1)
    before = np.maximum(after - 1, 0)
    nearer = np.abs(others_ns[after] - times_ns) - np.abs(times_ns - others_ns[before])
    is_before = nearer >= (1 if late else 0)
    return np.where(is_before, before, after)
