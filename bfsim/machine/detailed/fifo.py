"""The FIFO of a DMA channel: what was read on one side and waits to be written on the other."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

import simpy

from bfsim.machine.simulation import Simulation


class Element(NamedTuple):
    """What a DMA moves at a time, and the tick at which it is there."""

    value: bytes
    there_at: int


class Fifo:
    """Elements between the two sides of a transfer; the two wait for each other by `changed`.

    Where the sides take turns, it is filled before anything leaves it, and emptied before more comes in.
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
        """Whether all have left, and no more come."""
        return self._is_closed and not self._elements

    @property
    def first(self) -> Element:
        """The element that leaves next."""
        return self._elements[0]

    @property
    def there_at(self) -> int:
        """Tick at which that is there; where the sides take turns, all of them must be."""
        return self._elements[-1 if self._takes_turns else 0].there_at

    def put(self, element: Element) -> None:
        """Let an element in."""
        self._elements.append(element)
        self._is_draining |= len(self._elements) == self.depth
        self._change()

    def take(self) -> None:
        """Let the first element leave."""
        self._elements.popleft()
        self._is_draining &= bool(self._elements)
        self._change()

    def close(self) -> None:
        """Tell that no more come."""
        self._is_closed = self._is_draining = True
        self._change()

    def changed(self) -> simpy.Event:
        """Return the event at which something comes in or leaves the next time."""
        event = self._env.event()
        self._waits.append(event)
        return event

    def _change(self) -> None:
        waits, self._waits = self._waits, []
        for event in waits:
            event.succeed()
