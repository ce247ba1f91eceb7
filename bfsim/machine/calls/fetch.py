"""Instruction fetch from outside L1: what the code of a kernel call asks of the memories, beside its data.

Cached code is fetched a line at a time, when the call first comes to it; a line is in the cache until others of its set were
used later. Code that is not cached is fetched 64 bits at a time, as often as it is executed, spread evenly over the call
(an approximation: nothing is fetched ahead, and where in the call is not known).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.spec import CacheSpec
from bfsim.kernel import Work
from bfsim.kernel import access_trace as log
from bfsim.kernel.access_trace import AccessTrace
from bfsim.kernel.counters import Counter
from bfsim.machine.bus.state import FETCH_BYTES
from bfsim.machine.memories import Row

SUBBANK_BYTES = 4096


class Runnable(Protocol):
    """A kernel bound to its rows."""

    def run(self, arguments: tuple[Row | int, ...]) -> Work:
        """Run it."""


class CodeCache:
    """Tags of the code cache: `ways` lines a set, the one used last at the end of its list."""

    def __init__(self, spec: CacheSpec) -> None:
        self.line_bytes = spec.line_bytes
        self._ways = spec.code_ways
        sets = spec.code_bytes // (spec.line_bytes * spec.code_ways)
        self._sets: list[list[int]] = [[] for _ in range(sets)]

    def _set_of(self, line: int) -> int:
        """Return the set of a line: addr[9:5] in the sub-bank of 4 KB that addr[13:12] names (Programming Reference p.243)."""
        at = line * self.line_bytes
        per_bank = SUBBANK_BYTES // (self.line_bytes * self._ways)
        return at // SUBBANK_BYTES * per_bank % len(self._sets) + line % per_bank

    def miss(self, lines: Iterable[int]) -> list[int]:
        """Use `lines` one after the other; return those that were not there."""
        missed = []
        for line in lines:
            kept = self._sets[self._set_of(line)]
            if line in kept:
                kept.remove(line)
            else:
                missed.append(line)
                if len(kept) == self._ways:
                    del kept[0]
            kept.append(line)
        return missed


@dataclass(frozen=True, slots=True)
class Code:
    """Where the code of a kernel and of its callees lies outside L1: (offset in the arena, bytes) by routine."""

    places: Mapping[str, tuple[int, int]]

    def lines(self, line_bytes: int) -> list[int]:
        """Return the cache lines that it fills."""
        return [
            line
            for offset, nbytes in self.places.values()
            for line in range(offset // line_bytes, (offset + nbytes - 1) // line_bytes + 1)
        ]


class CodeOutside:
    """The kernels of one core whose code lies outside L1, and the cache that holds it, if the LDF has one."""

    def __init__(self, places: Mapping[str, tuple[int, int]], cache: CodeCache | None) -> None:
        """`places`: (offset in the arena, bytes) of each routine outside L1."""
        self.cache = cache
        self._places = places

    def of(self, counters: Iterable[Counter]) -> Code | None:
        """Return what of a kernel and its callees lies outside L1, None if nothing does."""
        routines = {each.routine: None for each in counters}
        places = {routine: self._places[routine] for routine in routines if routine in self._places}
        return Code(places) if places else None


class FetchedCall:
    """A call whose code lies outside L1: its fetches are added to what its access trace has."""

    def __init__(
        self, call: Runnable, code: Code, counters: Iterable[Counter], totals: NDArray[np.int64],
        access_trace: AccessTrace, cache: CodeCache | None,
    ) -> None:  # fmt: skip
        self._call = call
        self._totals = totals
        self._access_trace = access_trace
        self._cache = cache
        self._code = code
        self._lines = code.lines(cache.line_bytes) if cache else []
        outside = [each.nbytes if each.routine in code.places else 0 for each in counters]
        self._nbytes = np.array(outside or [0], np.int64)

    @property
    def stays_in_l1(self) -> bool:
        """Whether no access can leave L1: its code does."""
        return False

    def run(self, arguments: tuple[Row | int, ...]) -> Work:
        """Run the kernel now and say what it cost."""
        before = self._totals.copy()
        work = self._call.run(arguments)
        fetches = self._line_fills() if self._cache else self._single_fetches(work, self._totals - before)
        if len(fetches):
            work.accesses = self._access_trace.insert(work.accesses, fetches)
        return work

    def _line_fills(self) -> NDArray[np.int64]:
        assert self._cache
        line_bytes = self._cache.line_bytes
        offsets = [line * line_bytes for line in self._cache.miss(self._lines)]
        return np.array(offsets, np.int64) | log.FETCH_LINE << log.KIND_BIT

    def _single_fetches(self, work: Work, events: NDArray[np.int64]) -> NDArray[np.int64]:
        """One fetch for every 64 bits that were executed, from the routines' code in turn."""
        count = -(-int(events @ self._nbytes) // FETCH_BYTES)
        number = np.arange(count, dtype=np.int64)
        stamps = number * (work.issue_cclk + work.stall_cclk) // max(1, count)
        words = np.concatenate(
            [np.arange(at, at + nbytes, FETCH_BYTES) for at, nbytes in self._code.places.values()]
        )
        offsets = words[number % len(words)]
        fetches: NDArray[np.int64] = stamps << log.STAMP_BIT | log.FETCH << log.KIND_BIT | offsets
        return fetches
