"""When the built-in firmware calls its kernels for the first time, and on which rows: what is compiled ahead should be there by then."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import NamedTuple

from bfsim.files import store
from bfsim.kernel import Kernel

FIRST_CALLS = "first_calls"
"""What comes with bfsim under this name: symbols of kernels in the order of their first calls, and behind some of them `OUTSIDE`."""
OUTSIDE = "outside"


class FirstCall(NamedTuple):
    """The first call of a kernel; `is_outside`: whether one of its rows lies outside of L1."""

    kernel: Kernel
    is_outside: bool


def in_order(kernels: Iterable[Kernel]) -> list[FirstCall]:
    """Return kernels in the order in which the built-in firmware first calls them, where its own LDF places the rows.

    Those that it does not call are behind, in the order of their symbols, and taken to be called on rows in L1.
    """
    known = _first_calls()
    places = {symbol: number for number, symbol in enumerate(known)}

    def place(kernel: Kernel) -> tuple[int, str]:
        return places.get(kernel.function.symbol, len(places)), kernel.function.symbol

    return [FirstCall(each, known.get(each.function.symbol, False)) for each in sorted(kernels, key=place)]


@cache
def _first_calls() -> dict[str, bool]:
    """Return the symbols, and whether each kernel's first call is on a row outside of L1."""
    rows = (store.shipped(__package__, FIRST_CALLS) or b"").decode().splitlines()
    return {symbol: where == OUTSIDE for symbol, _, where in (each.partition(" ") for each in rows)}
