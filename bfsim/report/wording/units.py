"""Sizes of memory, rates of clocks and large counts in words."""

from __future__ import annotations

KIB = 1024
MIB = 1024 * KIB
MILLION = 1_000_000


def size(nbytes: int) -> str:
    """Return a size in the units of memories: 1 KB is 1024 bytes."""
    if nbytes < KIB:
        return f"{nbytes} B"
    return f"{nbytes / KIB:.1f} KB" if nbytes < MIB else f"{nbytes / MIB:.2f} MB"


def mhz(hz: float) -> str:
    """Return a rate in MHz."""
    return f"{hz / 1e6:.6g} MHz"


def milliseconds_of(cclk: float, hz: float) -> str:
    """Return a time in ms, to a microsecond: 74.344 ms."""
    return f"{cclk * 1000 / hz:.3f} ms"


def counted(number: int, *, sign: bool = False) -> str:
    """Return a count with thousands separated, from ten millions on in millions: 1,843,200 and 303.54 M.

    With `sign`, also that of positive ones.
    """
    plus = "+" if sign else ""
    return f"{number / MILLION:{plus},.2f} M" if abs(number) >= 10 * MILLION else f"{number:{plus},}"


def shortened(number: int) -> str:
    """Return a count with thousands separated, from a thousand millions on in whole millions: 1,843,200 and 3,035M."""
    return f"{number:,}" if number < 1000 * MILLION else f"{number / MILLION:,.0f}M"


def others_row(count: int) -> str:
    """Return the name of the row for everything that is not shown."""
    return f"({count:,} {'other' if count == 1 else 'others'})"
