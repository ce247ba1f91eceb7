"""The port of L2 as core B meets it while it spins on a lock, one try after the other: what the board must agree with."""

from __future__ import annotations

from tests.machine.made_boards import CHIP

assert CHIP.l2 is not None
L2 = CHIP.l2
LOCKED_CCLK = L2.read_cclk + L2.next_cclk
"""How long a TESTSET holds the port: its read and its write."""
TESTSET_CCLK = CHIP.events.testset_cclk + LOCKED_CCLK
BETWEEN_CCLK = CHIP.events.spin_cclk + CHIP.events.testset_cclk
"""From the end of a try to the moment at which the next one asks for the port."""


def post_against_spin(first_try_cclk: int, asks_cclk: int) -> tuple[int, int]:
    """Return when core A's TESTSET ends that asks at `asks_cclk`, and B's first one behind it; B's first try ends as told."""
    free = first_try_cclk
    while True:
        granted = free + BETWEEN_CCLK
        if asks_cclk <= granted:  # of two that ask at once it is A's turn, since B had the port before
            end = max(asks_cclk, free) + LOCKED_CCLK
            return end, max(granted, end) + LOCKED_CCLK
        free = granted + LOCKED_CCLK


def store_against_spin(first_try_cclk: int, asks_cclk: int) -> int:
    """Return when B's first try ends that has the port a cycle after A's store asks for it, or later."""
    free, asks, is_stored = first_try_cclk, first_try_cclk + BETWEEN_CCLK, False
    while True:
        granted = max(asks, free)
        if not is_stored and max(asks_cclk, free) < granted:
            free, is_stored = max(asks_cclk, free) + L2.next_cclk, True
            continue
        free = granted + LOCKED_CCLK
        if granted > asks_cclk:
            return free
        asks = free + BETWEEN_CCLK
