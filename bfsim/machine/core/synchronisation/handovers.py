"""Buffers that the cores hand over to each other: one core at a time works on such a buffer, until it gives it away.

A core gives away what it has whenever it posts a semaphore, gives a lock back or interrupts the other core. Whichever core takes
that semaphore, lock or interrupt may work on the buffer from then on. So the cycle of each access does not matter, and calls on
such buffers can be made ahead. A core that works on one out of turn ends the run: its cycles would decide what it finds.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import FirmwareError

Gifts = dict[str, int]
"""How often each core had given away what it has."""


class Handovers:
    """What each core has given away and knows of: a vector clock (Mattern 1989) for each core and each object waited for."""

    def __init__(self, cores: Iterable[str]) -> None:
        self._given = {core: np.zeros(1, np.int64) for core in cores}
        self._known: dict[str, Gifts] = {
            core: {} for core in cores
        }  # by core: the other cores' gifts that it knows of
        self._carried: dict[str, Gifts] = {}
        self._users: dict[
            str, tuple[str, int]
        ] = {}  # by buffer: the core that worked on it last, and its gifts so far

    def give(self, core: str, by: str) -> None:
        """Note that a core gives away what it has, by a semaphore, a lock or an interrupt."""
        self._given[core] += 1
        own = {core: int(self._given[core][0])}
        self._carried[by] = _latest(self._carried.get(by, {}), self._known[core] | own)

    def take(self, core: str, by: str) -> None:
        """Note that a core has waited for a semaphore or a lock, or has been interrupted."""
        self._known[core] = _latest(self._known[core], self._carried.get(by, {}))

    def use(self, core: str, buffer: str) -> None:
        """Note that a core works on a buffer. Raises FirmwareError if another core may be working on it."""
        user, gifts = self._users.get(buffer, (core, 0))
        if user != core and self._known[core].get(user, 0) <= gifts:
            raise FirmwareError(
                f"core {core} must not work on {buffer} while core {user} has it: the buffer is handed over (handed_over=True), "
                f"but core {user} worked on it last, and core {core} has waited for nothing that core {user} has posted since. Wait "
                f"for a semaphore first that core {user} posts when it is done, or declare {buffer} without handed_over"
            )
        self._users[buffer] = core, int(self._given[core][0])

    def turn_of(self, core: str) -> NDArray[np.int64]:
        """Return the live count of a core's gifts. Until it changes, whatever the core works on is its own."""
        return self._given[core]


def _latest(one: Gifts, other: Gifts) -> Gifts:
    """Return the gifts known from both together."""
    return {core: max(one.get(core, 0), other.get(core, 0)) for core in {**one, **other}}
