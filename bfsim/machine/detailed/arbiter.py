"""The arbiter of a memory in the detailed mode: one transaction of a master at a time.

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
    """How an access went: tick of the grant, when the next can be given, and when its first and its last data are through."""

    at: int
    free: int
    first_through: int
    through: int
    page: Page
    refresh_wait: int


def never() -> bool:
    """Whether a master is urgent that cannot be."""
    return False


@dataclass(eq=False, slots=True)
class Request:
    """A transaction that a master asks for. `owner`: of the memory. `granted` happens with a Grant when it has the bus."""

    granted: simpy.Event
    master: int
    owner: int
    nbytes: int
    _: KW_ONLY
    write: bool
    offset: int = 0
    is_urgent: Callable[[], bool] = never
    hold_cclk: int = 0
    """How long it holds the port of L2."""


def wait_until(env: Simulation, tick: int) -> Generator[simpy.Event, Any, None]:
    """Wait until `tick`, unless it is over."""
    if tick > env.tick:
        yield env.after(tick - env.tick)


def traffic_at(owner: int, master: int) -> int:
    """Return where in the state it is counted what a master moves to or from memory of an owner."""
    return w.TRAFFIC_AT + (owner * w.MASTERS + master) * w.TRAFFIC_WORDS


def count_bytes(words: Any, master: int, owner: int, nbytes: int, *, write: bool) -> None:
    """Count what a master moved to or from memory of an owner."""
    words[traffic_at(owner, master) + (w.WRITTEN_BYTES if write else w.READ_BYTES)] += nbytes


class CoreTurns:
    """How the cores take turns: the one that was served last comes behind the other."""

    def __init__(self) -> None:
        self._last_core = 1

    def rank(self, master: int) -> tuple[int, ...]:
        """Return a key by which the master of a core that is served first is the least."""
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
        """Return a key by which the request that is served first is the least."""

    def serve(self, request: Request) -> Grant:
        """Do what is asked for, from now on."""


class Arbiter:
    """Whoever asks for a transaction of a memory waits until it is free, and the best of them has it."""

    def __init__(self, env: Simulation, memory: Memory) -> None:
        self._env = env
        self._memory = memory
        self._requests: list[Request] = []
        self._asked = env.event()
        env.process(self._play())

    def ask(self, request: Request) -> simpy.Event:
        """Ask for a transaction; return the event of its grant."""
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
        """Return the event at which all have asked that ask until `tick`."""
        event = self._env.event()
        event._ok, event._value = True, None  # noqa: SLF001  # as simpy.Timeout does
        self._env.schedule(event, LAST_OF_A_TICK, max(0, tick - self._env.tick))
        return event
