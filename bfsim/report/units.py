"""Sizes of memory and rates of clocks for people."""

from __future__ import annotations

KIB = 1024
MIB = 1024 * KIB


def size(nbytes: int) -> str:
    """Return a size in the unit of memories: 1 KB is 1024 bytes."""
    if nbytes < KIB:
        return f"{nbytes} B"
    return f"{nbytes / KIB:.1f} KB" if nbytes < MIB else f"{nbytes / MIB:.2f} MB"


def mhz(hz: float) -> str:
    """Return a rate in MHz."""
    return f"{hz / 1e6:.6g} MHz"
