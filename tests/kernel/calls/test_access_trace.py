"""The access trace: every access of a kernel outside L1 is logged, or what the data cache makes of it."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from bfsim.errors import KernelError
from bfsim.kernel import i32, kernel, u8
from bfsim.kernel.calls import access_log as log
from bfsim.kernel.calls.access_log import FILL, LOAD, STORE, WRITE_BACK, Policy
from bfsim.kernel.calls.access_trace import AccessTrace, CachedRegion, CacheSize
from tests.kernel.running import run

OUTSIDE, L1 = 8192, 4096  # bytes of the arena: first what is traced, then what is not
SMALL = CacheSize(nbytes=512, line_bytes=32, ways=2)  # eight sets
Entry = tuple[int, int]


@kernel
def stroll(source: u8[:], target: u8[:], start: i32, step: i32, n: i32) -> i32:
    total = 0
    for i in range(n):
        here = source[start + i * step]
        total += here
        target[i * step] = here
    return total


@kernel
def add_to(target: i32[:], value: i32):
    for i in range(len(target)):
        target[i] += value


@dataclass
class Memory:
    """An arena with an access trace."""

    cached: Sequence[CachedRegion] = ()
    size: CacheSize = SMALL
    entries: int = 4096
    arena: NDArray[np.uint8] = field(init=False)
    access_trace: AccessTrace = field(init=False)

    def __post_init__(self) -> None:
        self.arena = np.zeros(OUTSIDE + L1, np.uint8)
        room = np.zeros(log.LOG + log.ENTRY_WORDS * self.entries, np.int64)
        self.access_trace = AccessTrace(self.arena, OUTSIDE, room, self.cached, self.size)

    @property
    def l1(self) -> NDArray[np.uint8]:
        """Memory that is not traced."""
        return self.arena[OUTSIDE:]

    def stroll(
        self, source: NDArray[np.uint8], target: NDArray[np.uint8], start: int, step: int, n: int
    ) -> list[Entry]:
        """Run the kernel; return (kind, offset) of what was logged."""
        return self.logged(
            run(stroll, source, target, start, step, n, access_trace=self.access_trace).accesses
        )

    def logged(self, count: int) -> list[Entry]:
        """Return (kind, offset) of the first entries."""
        entries = self.access_trace.entries(count).tolist()
        return [(each >> log.KIND_BIT & log.KIND_MASK, each & log.OFFSET_MASK) for each in entries]


def test_loads_and_stores_are_logged_in_their_order() -> None:
    """Kind and offset of each; L1 is not traced."""
    memory = Memory()
    source, target = memory.arena[100:200], memory.arena[1000:1100]
    expected = [entry for i in range(40) for entry in ((LOAD, 100 + i), (STORE, 1000 + i))]
    assert memory.stroll(source, target, 0, 1, 40) == expected
    assert memory.stroll(source, memory.l1, 0, 1, 40) == expected[::2]
    assert memory.stroll(memory.l1, target, 0, 1, 40) == expected[1::2]
    assert memory.stroll(memory.l1[:50], memory.l1[100:], 0, 1, 40) == []


def test_the_last_byte_outside_is_followed_and_the_next_one_is_not() -> None:
    """The border is exact on both sides."""
    memory = Memory()
    assert memory.stroll(memory.arena[OUTSIDE - 1 :], memory.l1[100:], 0, 1, 1) == [(LOAD, OUTSIDE - 1)]
    assert memory.stroll(memory.arena[OUTSIDE:], memory.l1[100:], 0, 1, 1) == []


def test_a_word_is_one_access() -> None:
    """32 bits at a time, read and written in place."""
    memory = Memory()
    words = memory.arena[256:320].view(np.int32)
    work = run(add_to, words, 7, access_trace=memory.access_trace)
    assert memory.logged(work.accesses) == [(kind, 256 + 4 * i) for i in range(16) for kind in (LOAD, STORE)]
    assert (words == 7).all()


def test_stamps_are_the_cycles_of_the_call() -> None:
    """They grow from one iteration of the loop to the next by what the iteration costs, and end before the call does."""
    memory = Memory()
    work = run(stroll, memory.arena, memory.l1, 0, 1, 50, access_trace=memory.access_trace)
    stamps = memory.access_trace.entries(50) >> log.STAMP_BIT
    iterations = np.diff(stamps)
    assert (iterations == iterations[0]).all()
    longer = run(stroll, memory.arena, memory.l1, 0, 1, 51, access_trace=memory.access_trace)
    assert iterations[0] == longer.issue_cclk + longer.stall_cclk - work.issue_cclk - work.stall_cclk
    assert 0 <= stamps[0] < stamps[-1] < work.issue_cclk + work.stall_cclk


def test_the_log_begins_anew_with_every_call() -> None:
    """What a call logs are its own accesses."""
    memory = Memory()
    for start in (0, 7, 90):
        assert memory.stroll(memory.arena, memory.l1, start, 1, 2) == [(LOAD, start), (LOAD, start + 1)]


def test_a_full_log_is_told_and_overwrites_nothing() -> None:
    """As many as fit are fine; one more is an error that says what to do, and the next call works again."""
    memory = Memory(entries=10)
    assert len(memory.stroll(memory.arena, memory.l1, 0, 1, 10)) == 10
    with pytest.raises(
        KernelError, match="must access memory outside L1 at most 10 times, not 11 times: split it"
    ):
        memory.stroll(memory.arena, memory.l1, 0, 1, 11)
    assert len(memory.stroll(memory.arena, memory.l1, 0, 1, 3)) == 3


def test_following_changes_neither_pixels_nor_cycles() -> None:
    """The traced build stores the same values, returns the same and issues the same cycles."""
    memory = Memory()
    source, seen = memory.arena[:64], memory.arena[64:128]
    source[:] = np.arange(64)
    plain = np.zeros(64, np.uint8)
    bare = run(stroll, source, plain, 0, 1, 64)
    traced = run(stroll, source, seen, 0, 1, 64, access_trace=memory.access_trace)
    assert (bare.issue_cclk, bare.value) == (traced.issue_cclk, traced.value)
    assert (bare.accesses, traced.accesses) == (0, 128)
    np.testing.assert_array_equal(plain, seen)


# ---- Caches


class NaiveCache:
    """A cache in plain Python: in each set the lines in the order of their use, and whether they were changed."""

    def __init__(self, size: CacheSize, regions: Sequence[CachedRegion]) -> None:
        self._size, self._regions = size, regions
        self._sets: list[OrderedDict[int, bool]] = [OrderedDict() for _ in range(size.sets)]

    def access(self, offset: int, *, write: bool) -> list[Entry]:
        """Return what an access asks of the memories."""
        region = next((each for each in self._regions if each.first <= offset < each.end), None)
        if region is None:
            return [(STORE if write else LOAD, offset)]
        line = offset // self._size.line_bytes
        lines = self._sets[line % self._size.sets]
        through = write and region.policy is Policy.WRITE_THROUGH
        asked: list[Entry] = [(STORE, offset)] if through else []
        if line in lines:
            lines.move_to_end(line)
            lines[line] |= write and not through
        elif not through:
            if len(lines) == self._size.ways:
                old, changed = lines.popitem(last=False)
                asked += [(WRITE_BACK, old * self._size.line_bytes)] if changed else []
            lines[line] = write
            asked.append((FILL, line * self._size.line_bytes))
        return asked


def test_a_cached_row_is_filled_line_by_line() -> None:
    """100 bytes from the middle of a line on lie in four of them; read again they cost nothing."""
    memory = Memory([CachedRegion(0, 4096, Policy.WRITE_THROUGH)])
    assert memory.stroll(memory.arena, memory.l1, 16, 1, 100) == [(FILL, line) for line in (0, 32, 64, 96)]
    assert memory.stroll(memory.arena, memory.l1, 16, 1, 100) == []


def test_written_through_every_store_goes_to_memory_and_fetches_nothing() -> None:
    """The line is not allocated, so a load behind it fills it."""
    memory = Memory([CachedRegion(0, 4096, Policy.WRITE_THROUGH)])
    assert memory.stroll(memory.l1, memory.arena, 0, 8, 4) == [(STORE, 8 * i) for i in range(4)]
    assert memory.stroll(memory.arena, memory.l1, 0, 8, 4) == [(FILL, 0)]


def test_written_back_a_line_leaves_when_its_way_is_wanted() -> None:
    """Two ways: the third line of a set drives out the one used longest ago, which was changed."""
    memory = Memory([CachedRegion(0, 4096, Policy.WRITE_BACK)])
    way = SMALL.sets * SMALL.line_bytes
    assert memory.stroll(memory.l1, memory.arena, 0, way, 3) == [
        (FILL, 0),
        (FILL, way),
        (WRITE_BACK, 0),
        (FILL, 2 * way),
    ]


def test_a_cache_forgets_what_dma_has_overwritten() -> None:
    """Its lines are filled again, all that the bytes touch and no others; changes of theirs are lost."""
    memory = Memory([CachedRegion(0, 4096, Policy.WRITE_BACK)])
    memory.stroll(memory.l1, memory.arena, 0, 32, 6)
    assert memory.access_trace.forget(33, 64) == 3
    assert memory.stroll(memory.arena, memory.l1, 0, 32, 6) == [(FILL, 32), (FILL, 64), (FILL, 96)]
    assert Memory().access_trace.forget(0, 64) == 0


regions = st.tuples(st.integers(0, 20), st.integers(0, 40), st.sampled_from(Policy)).map(
    lambda drawn: CachedRegion(96 * drawn[0], 96 * (drawn[0] + drawn[1]), drawn[2])
)
sizes = st.sampled_from([SMALL, CacheSize(256, 32, 1), CacheSize(1024, 32, 4), CacheSize(512, 32, 16)])
walks = st.lists(
    st.tuples(st.integers(0, 2000), st.integers(2000, 4000), st.integers(0, 90), st.integers(0, 20)),
    max_size=5,
)


@given(first=regions, second=regions, size=sizes, walked=walks)
def test_any_walk_asks_for_what_the_naive_cache_says(
    first: CachedRegion, second: CachedRegion, size: CacheSize, walked: list[tuple[int, int, int, int]]
) -> None:
    """Over cached and uncached regions, through calls: the same fills, write-backs, loads and stores in the same order."""
    cached = [first, second]
    memory, naive = Memory(cached, size), NaiveCache(size, cached)
    for start, target_at, step, n in walked:
        expected = []
        for i in range(n):
            expected += naive.access(start + i * step, write=False)
            expected += naive.access(target_at + i * step, write=True)
        target = memory.arena[target_at:]
        assert memory.stroll(memory.arena, target, start, step, n) == expected
