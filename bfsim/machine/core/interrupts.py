"""Interrupts of one core: SIC and CEC, from a device's request to the handler that the firmware attached.

A core takes an interrupt where it meets the rest of the machine, or while it waits there: calls are never interrupted. Of several
pending interrupts, the lowest IVG level goes first, then the lowest number. Handlers are not interrupted themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import simpy

from bfsim.chip.interrupts import SicInterrupt
from bfsim.errors import FirmwareError
from bfsim.machine.simulation import Simulation

CoreHandler = Callable[[Any], Any]
"""Called with the core: a function, or a generator function that yields kernels as a main loop does."""
Handler = Callable[[], Any]
"""The same, bound to its core."""


class Interrupts:
    """The attached handlers and the pending interrupts of one core."""

    def __init__(self, env: Simulation, core: str, sources: type[SicInterrupt]) -> None:
        self._env = env
        self._core = core
        self._sources = sources
        self._handlers: dict[SicInterrupt, Handler] = {}
        self._waiting: set[SicInterrupt] = set()
        self._raised = env.event()
        self.are_handled = False
        """Whether any interrupt has a handler."""
        self.is_held = False
        """Whether none is taken now, because a handler runs or the core's clock is not where its firmware is."""
        self.counts: dict[str, int] = {}
        """Numbers of interrupts taken, by source."""

    def source(self, name: str) -> SicInterrupt:
        """Return the interrupt called `name`, or raise FirmwareError."""
        known = self._sources.__members__
        if name not in known:
            raise FirmwareError(f"an interrupt must be one of {', '.join(known)}, not {name!r}")
        return known[name]

    def attach(self, name: str, handler: Handler) -> None:
        """Unmask an interrupt and attach `handler` to it."""
        self._handlers[self.source(name)] = handler
        self.are_handled = True

    def request(self, name: str) -> None:
        """Request an interrupt now. A pending source is not counted twice, and one without a handler is masked."""
        source = self.source(name)
        if source in self._handlers:
            self._waiting.add(source)
            event, self._raised = self._raised, self._env.event()
            event.succeed()

    @contextmanager
    def held(self) -> Iterator[None]:
        """Take no interrupt inside this context."""
        before, self.is_held = self.is_held, True
        yield
        self.is_held = before

    @property
    def can_come(self) -> bool:
        """Whether a handler would be called if its interrupt came now."""
        return self.are_handled and not self.is_held

    @property
    def can_be_taken(self) -> bool:
        """Whether an interrupt is pending whose handler can be called now."""
        return self.can_come and self.is_waiting

    @property
    def is_waiting(self) -> bool:
        """Whether any interrupt is pending."""
        return bool(self._waiting)

    def take(self) -> tuple[str, Handler]:
        """Take the first interrupt in order. Return its source and its handler."""
        source = min(self._waiting, key=lambda each: (each.ivg, each.value))
        self._waiting.remove(source)
        self.counts[source.name] = self.counts.get(source.name, 0) + 1
        return source.name, self._handlers[source]

    def next_request(self) -> simpy.Event:
        """Return the event at which the next interrupt is requested."""
        return self._raised
