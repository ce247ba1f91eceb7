"""The time that compiled code takes by itself: kernels and the weave, without the Python that calls them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from time import thread_time_ns
from typing import Any
from unittest.mock import patch

from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.calls.call_cache import KnownCall


@dataclass(slots=True)
class Stopwatch:
    """How long compiled functions have run in processor time, their calls from Python included, some 0.2 µs each."""

    ns: int = 0
    calls: int = 0

    @property
    def seconds(self) -> float:
        """All of it, without what looking at the clock takes."""
        return (self.ns - self.calls * own_ns()) * 1e-9

    def on(self, function: Callable[..., int]) -> Callable[..., int]:
        """Return a function with its time taken."""

        def timed(*arguments: int) -> int:
            begin = thread_time_ns()
            result = function(*arguments)
            self.ns += thread_time_ns() - begin
            self.calls += 1
            return result

        return timed


@cache
def own_ns() -> float:
    """Return what a stopwatch shows for a function that does nothing."""
    empty, times = Stopwatch(), 100_000
    timed = empty.on(int)
    for _ in range(times):
        timed()
    return empty.ns / times


@contextmanager
def native_time(kernels: Stopwatch, weave: Stopwatch) -> Iterator[None]:
    """Take the time of kernels and of the weave, in boards that are made inside."""
    with (
        patch.object(KnownCall, "__init__", _after(KnownCall, "run", kernels, words=0)),  # Python runs them
        patch.object(WovenBus, "__init__", _after(WovenBus, "_advance", weave)),
    ):
        yield


def _after(kind: type, function: str, stopwatch: Stopwatch, **values: int) -> Callable[..., None]:
    """Return what makes an object of `kind`, whose `function` then has its time taken, with other `values`."""
    make: Any = kind.__init__

    def made(self: Any, *arguments: Any, **named: Any) -> None:
        make(self, *arguments, **named)
        for name, value in {function: stopwatch.on(getattr(self, function)), **values}.items():
            object.__setattr__(self, name, value)  # some are frozen

    return made
