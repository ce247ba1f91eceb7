"""The order in which the built-in firmware first calls its kernels, and on which buffers: compilation ahead follows it."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import NamedTuple

from bfsim.files import store
from bfsim.kernel import Kernel

FIRST_CALLS = "first_calls"
"""A file that comes with bfsim: symbols of kernels in the order of their first calls, each with the buffers of its rows."""


class FirstCall(NamedTuple):
    """The first call of a kernel, and the buffers whose rows it is given."""

    kernel: Kernel
    buffers: tuple[str, ...]


def in_order(kernels: Iterable[Kernel]) -> list[FirstCall]:
    """Return kernels in the order in which the built-in firmware first calls them.

    Those that it does not call come last, in the order of their symbols, and nothing is known of their rows.
    """
    known = _first_calls()
    places = {symbol: number for number, symbol in enumerate(known)}

    def place(kernel: Kernel) -> tuple[int, str]:
        return places.get(kernel.function.symbol, len(places)), kernel.function.symbol

    return [FirstCall(each, known.get(each.function.symbol, ())) for each in sorted(kernels, key=place)]


@cache
def _first_calls() -> dict[str, tuple[str, ...]]:
    """Return the buffers of each kernel, by its symbol."""
    rows = (store.shipped(__package__, FIRST_CALLS) or b"").decode().splitlines()
    return {symbol: tuple(buffers) for symbol, *buffers in map(str.split, rows)}
