"""The FIFO of a DMA channel: elements that were read on one side and wait to be written on the other."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

import simpy

from bfsim.machine.simulation import Simulation


class Element(NamedTuple):
    """The unit that a DMA moves, and the tick at which it is there."""

    value: bytes
    there_at: int


class Fifo:
    """Elements between the two sides of a transfer, which wait for each other by `changed`.

    If the sides take turns, it is filled before anything leaves it, and emptied before more comes in.
    """

    def __init__(self, env: Simulation, depth: int, *, takes_turns: bool) -> None:
        self.depth = depth
        self._env = env
        self._elements: deque[Element] = deque()
        self._takes_turns = takes_turns
        self._is_draining = False
        self._is_closed = False
        self._waits: list[simpy.Event] = []

    def __len__(self) -> int:
        return len(self._elements)

    @property
    def has_room(self) -> bool:
        """Whether an element can come in."""
        return len(self._elements) < self.depth and not (self._takes_turns and self._is_draining)

    @property
    def can_give(self) -> bool:
        """Whether an element can leave."""
        return bool(self._elements) and (not self._takes_turns or self._is_draining)

    @property
    def is_done(self) -> bool:
        """Whether all elements have left and no more will come."""
        return self._is_closed and not self._elements

    @property
    def first(self) -> Element:
        """The element that leaves next."""
        return self._elements[0]

    @property
    def there_at(self) -> int:
        """Tick at which the first element can leave. If the sides take turns, all must be there."""
        return self._elements[-1 if self._takes_turns else 0].there_at

    def put(self, element: Element) -> None:
        """Put in an element."""
        self._elements.append(element)
        self._is_draining |= len(self._elements) == self.depth
        self._change()

    def take(self) -> None:
        """Take out the first element."""
        self._elements.popleft()
        self._is_draining &= bool(self._elements)
        self._change()

    def close(self) -> None:
        """Note that no more elements will come."""
        self._is_closed = self._is_draining = True
        self._change()

    def changed(self) -> simpy.Event:
        """Return the event at which something next comes in or leaves."""
        event = self._env.event()
        self._waits.append(event)
        return event

    def _change(self) -> None:
        waits, self._waits = self._waits, []
        for event in waits:
            event.succeed()
