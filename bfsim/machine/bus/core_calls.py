"""The cores on the bus: a call plays its log of accesses, and a core that waits for a lock repeats TESTSET."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.kernel.calls import access_log as log
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import CoreLogs
from bfsim.machine.bus.ends import Ends


def spin_ticks(board: BoardSpec) -> int:
    """Return the ticks from the end of a spinning core's TESTSET until the next one requests its memory."""
    events = board.chip.events
    return (events.spin_cclk + events.testset_cclk) * board.clocks.cclk_ticks


class CoreCalls(Protocol):
    """The accesses that each core has the buses play."""

    def access(self, core: int, begin: int, cclk: int, entries: int) -> simpy.Event:
        """Play the first `entries` accesses of a core's log, for a call of `cclk` cycles from tick `begin`. Return its end."""

    def spin(self, core: int, since: int) -> None:
        """Let a core that found a lock taken at tick `since` repeat TESTSET until `stop_spinning`."""

    def pause_spinning(self, core: int) -> None:
        """Let a spinning core do something else."""

    def stop_spinning(self, core: int) -> simpy.Event:
        """Let the next TESTSET of a spinning core, from now on, be the last one. Return its end."""

    def stalls_of(self, core: int) -> Sequence[int]:
        """Return the stalls of the core's last call by its accesses, in cycles, in the order of `bus.state`."""


class WovenCalls:
    """`CoreCalls` by the compiled weave. `words` is the state of the bus; `settle` plays it up to now."""

    def __init__(
        self, board: BoardSpec, words: Any, logs: CoreLogs, ends: Ends, settle: Callable[[], None]
    ) -> None:
        self._words = words
        self._logs = logs
        self._ends = ends
        self._settle = settle
        self._spin_ticks = spin_ticks(board)

    def access(self, core: int, begin: int, cclk: int, entries: int) -> simpy.Event:
        """Play a call's accesses."""
        self._start(core, begin, cclk, entries)
        return self._ends.of_call(core)

    def _start(self, core: int, begin: int, cclk: int, entries: int, spin: int = 0) -> None:
        self._settle()
        job, words = w.JOBS_AT + core * w.JOB_WORDS, self._words
        words[job + w.BEGIN], words[job + w.TOTAL] = begin, cclk
        words[job + w.END], words[job + w.SPIN] = entries, spin
        words[job + w.STATE] = w.STARTING

    def spin(self, core: int, since: int) -> None:
        """Spin until `stop_spinning`."""
        entries = self._logs.log_in_l2(core, 0, log.TEST_AND_SET)
        self._start(core, since + self._spin_ticks, 0, entries, self._spin_ticks)

    def pause_spinning(self, core: int) -> None:
        """Pause the spinning."""
        self._settle()
        self._words[w.JOBS_AT + core * w.JOB_WORDS + w.STATE] = w.IDLE
        self._words[w.MASTERS_AT + w.CORE_A + core + w.READY] = w.NEVER

    def stop_spinning(self, core: int) -> simpy.Event:
        """Let the next try be the last one."""
        self._settle()
        self._words[w.JOBS_AT + core * w.JOB_WORDS + w.SPIN] = 0
        return self._ends.of_call(core)

    def stalls_of(self, core: int) -> Sequence[int]:
        """Return the stalls of the last call."""
        first = w.JOBS_AT + core * w.JOB_WORDS + w.STALL
        stalls: list[int] = self._words[first : first + w.STALLS].tolist()
        return stalls
