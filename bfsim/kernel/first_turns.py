"""Ranges that C knows to have a first iteration: from something to a number more than that, as `range(x - 2, x + 3)` [match.pd of GCC 12].

A sum with a number does not wrap there, so one end is beyond the other. LLVM would test it, for kernels wrap.
"""

from __future__ import annotations

from bfsim.kernel import tree


def has_first(loop: tree.For) -> bool:
    """Whether `loop` iterates once at least, for its end is some number behind its start."""
    (start, first), (stop, last) = _parted(loop.start), _parted(loop.stop)
    if start is None or stop is None or not tree.alike(start, stop) or tree.calls_in((start,)):
        return False
    return first < last if loop.goes_up else last < first


def _parted(bound: tree.Expr) -> tuple[tree.Expr | None, int]:
    """What a bound is beside numbers that are added to it, and their sum."""
    more = 0
    while isinstance(bound, tree.Binary) and bound.op in ("+", "-") and isinstance(bound.right, tree.Const):
        more += int(bound.right.value) if bound.op == "+" else -int(bound.right.value)
        bound = bound.left
    return (None if isinstance(bound, tree.Const) else bound), more
