"""The arbiter of a memory in the detailed mode: one transaction of one master at a time.

The cores take turns, and their loads go before their stores [assumed].
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import KW_ONLY, dataclass
from typing import Any, Protocol

import simpy
from simpy.events import EventPriority

from bfsim.machine.bus import state as w
from bfsim.machine.detailed.sdram import Page
from bfsim.machine.simulation import Simulation

LAST_OF_A_TICK = EventPriority(2)  # simpy's own are 0 and 1

STORES = {w.STORES_A: 0, w.STORES_B: 1}
LOADS = {w.CORE_A: 0, w.CORE_B: 1}
CORE_OF = STORES | LOADS


@dataclass(frozen=True, slots=True)
class Grant:
    """The result of an access: ticks of the grant, of the next possible grant, and of the end of its first and last data."""

    at: int
    free: int
    first_through: int
    through: int
    page: Page
    refresh_wait: int


def never() -> bool:
    """Whether a master that is never urgent is urgent."""
    return False


@dataclass(eq=False, slots=True)
class Request:
    """A transaction that a master requests. `owner` owns the memory. `granted` happens with a Grant when it gets the bus."""

    granted: simpy.Event
    master: int
    owner: int
    nbytes: int
    _: KW_ONLY
    write: bool
    offset: int = 0
    is_urgent: Callable[[], bool] = never
    hold_cclk: int = 0
    """Cycles for which it holds the port of L2."""


def wait_until(env: Simulation, tick: int) -> Generator[simpy.Event, Any, None]:
    """Wait until `tick`, unless it has passed."""
    if tick > env.tick:
        yield env.after(tick - env.tick)


def traffic_at(owner: int, master: int) -> int:
    """Return where in the state the counters of a master's traffic with an owner's memory are."""
    return w.TRAFFIC_AT + (owner * w.MASTERS + master) * w.TRAFFIC_WORDS


def count_bytes(words: Any, master: int, owner: int, nbytes: int, *, write: bool) -> None:
    """Count bytes that a master moved to or from an owner's memory."""
    words[traffic_at(owner, master) + (w.WRITTEN_BYTES if write else w.READ_BYTES)] += nbytes


class CoreTurns:
    """How the cores take turns: the one served last comes after the other."""

    def __init__(self) -> None:
        self._last_core = 1

    def rank(self, master: int) -> tuple[int, ...]:
        """Return the key of a core's master. The least key is served first."""
        core = CORE_OF[master]
        return (master in STORES, core == self._last_core, core)

    def count(self, master: int) -> None:
        """Count a transaction of a master, if it is a core's."""
        self._last_core = CORE_OF.get(master, self._last_core)


class Memory(Protocol):
    """A memory that serves one transaction at a time."""

    def free_at(self) -> int:
        """Tick from which the next transaction can be served."""

    def is_held_up(self) -> bool:
        """Whether the memory does something of its own first."""

    def rank(self, request: Request) -> tuple[int, ...]:
        """Return the key of a request. The least key is served first."""

    def serve(self, request: Request) -> Grant:
        """Serve the request from now on."""


class Arbiter:
    """Requests for a memory wait until it is free. The one with the best rank is served then."""

    def __init__(self, env: Simulation, memory: Memory) -> None:
        self._env = env
        self._memory = memory
        self._requests: list[Request] = []
        self._asked = env.event()
        env.process(self._play())

    def ask(self, request: Request) -> simpy.Event:
        """Request a transaction. Return the event of its grant."""
        self._requests.append(request)
        if not self._asked.triggered:
            self._asked.succeed()
        return request.granted

    def _play(self) -> Generator[simpy.Event, Any, None]:
        while True:
            if not self._requests:
                self._asked = self._env.event()
                yield self._asked
            yield self._everybody_asked(self._memory.free_at())
            if self._memory.is_held_up():
                continue
            request = min(self._requests, key=self._memory.rank)
            self._requests.remove(request)
            request.granted.succeed(self._memory.serve(request))

    def _everybody_asked(self, tick: int) -> simpy.Event:
        """Return the event at which all requests up to and including `tick` have been made."""
        event = self._env.event()
        event._ok, event._value = True, None  # noqa: SLF001  # as simpy.Timeout does
        self._env.schedule(event, LAST_OF_A_TICK, max(0, tick - self._env.tick))
        return event
