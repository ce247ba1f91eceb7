"""Recorded work as the bus of a board plays it: memory where it is here, and nothing that is not there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from bfsim.kernel import access_trace as log
from bfsim.machine.bus import state as w
from bfsim.machine.bus.memory_owners import MemoryOwner
from bfsim.machine.retiming import translate as translation
from bfsim.machine.retiming.translate import Translator
from bfsim.machine.retiming.work import Accesses, FrameWork, accesses_of
from tests.machine.rig import Bench

IN_SDRAM, IN_L1 = 3, 4
"""Owners of memory: the first ones are nobody."""
OPERATIONS = [
    (w.RUN, 7, 1, 0, 0),
    (w.ACCESS, 20, 2, 3, 0),
    (w.SET_UP, 3, 2, 5, 0),
    (w.COPY, 1, 0, 0, 0),
    (w.ACCESS, 30, 0, 1, 1),
]
STAMPS, BYTES, OWNERS, SITES = [2, 9, 11, 4], [8, 0, 4, 4], [IN_SDRAM, IN_L1, IN_SDRAM, IN_L1], [5, 6, 7, 8]


@pytest.fixture
def bench() -> Bench:
    """A board with a buffer in SDRAM and one in L1."""
    bench = Bench()
    bench.bus.owners.add(MemoryOwner("SDRAM", "far", 64), 4096)
    bench.bus.owners.add(MemoryOwner("CORE A", "near", 64), bench.memories.l1)
    return bench


def frame(operations: Any = OPERATIONS, **columns: Any) -> FrameWork:
    """Return work with these accesses, or with other `columns`."""
    given = {"stamps": STAMPS, "bytes_": BYTES, "owners": OWNERS, "sites": SITES} | columns
    stamps, bytes_, owners, sites = (np.array(each, np.int64) for each in given.values())
    entries = stamps << log.STAMP_BIT | log.LOAD << log.KIND_BIT | bytes_
    return FrameWork(
        core="B",
        operations=np.array(operations, np.int64),
        accesses=accesses_of(entries, sites, owners, np.zeros(4, np.int64)),
        events=np.zeros((0, 3), np.int64),
        copies=np.zeros((0, 6), np.int64),
        calls=(),
        accounts=(),
    )


def translated(bench: Bench, work: FrameWork) -> list[list[int]]:
    """Translate the work of core B, which has prepared two calls and two copies; return its operations on the bus."""
    translator = Translator(bench.bus, 1, bench.spec.chip.events)
    translator.add_call(w.ACCESS)
    translator.add_call(w.RUN)
    translator.add_copies(np.array([40, 41]))
    translator.begin(work)
    (count,) = translator.stretches(len(work.operations))
    first = w.OPERATIONS_AT + w.MAX_OPERATIONS * w.OPERATION_WORDS
    found = bench.bus.state[first : first + count * w.OPERATION_WORDS]
    return found.reshape(-1, w.OPERATION_WORDS).tolist()


def logged(bench: Bench, count: int) -> list[tuple[int, int, int]]:
    """Return stamp, offset in the arena and site of the first accesses that core B has on the bus."""
    room = bench.bus.room_of(1)[log.LOG :]
    entries, sites = room[:count], room[w.LOG_ENTRIES : w.LOG_ENTRIES + count]
    return [
        (entry >> log.STAMP_BIT, entry & log.OFFSET_MASK, site)
        for entry, site in zip(entries.tolist(), sites.tolist(), strict=True)
    ]


def test_accesses_to_what_is_in_l1_here_are_left_out(bench: Bench) -> None:
    """A call refers to the others; registers take the cycles of this chip, copies have their plans here."""
    events = bench.spec.chip.events
    assert translated(bench, frame()) == [
        [w.RUN, 7, 1, 0, 0],
        [w.ACCESS, 20, 2, 0, 2],
        [w.SET_UP, 3 * events.mmr_write_cclk + 2 * events.mmr_read_cclk, 5, 5, 0],
        [w.COPY, 41, 0, 0, 0],
        [w.RUN, 30, 0, 2, 2],
    ]
    assert logged(bench, 2) == [(2, 4096 + 8, 5), (11, 4096 + 4, 7)]


def test_plain_python_does_the_same(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """The compiled function is what is read."""
    compiled = translated(bench, frame())
    plain = Bench()
    plain.bus.owners.add(MemoryOwner("SDRAM", "far", 64), 4096)
    plain.bus.owners.add(MemoryOwner("CORE A", "near", 64), plain.memories.l1)
    monkeypatch.setattr(
        translation,
        "compiled",
        lambda *arrays: lambda: translation.translate.python(*(each.reshape(-1) for each in arrays)),
    )
    assert translated(plain, frame()) == compiled
    assert logged(plain, 2) == logged(bench, 2)


def test_a_stretch_that_has_no_room_is_played_in_parts(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """As many operations at a time as there is room for; accesses go on where they were."""
    translator = Translator(bench.bus, 0, bench.spec.chip.events)
    many = frame([(w.RUN, 1, 0, 0, 0)] * (w.MAX_OPERATIONS + 3))
    translator.begin(many)
    assert list(translator.stretches(len(many.operations))) == [w.MAX_OPERATIONS, 3]


@pytest.mark.parametrize(
    "broken",
    [
        frame(owners=[IN_SDRAM, IN_L1, 5, IN_L1]),
        frame(sites=[5, 6, w.MAX_SITES, 8]),
        frame(bytes_=[8, 0, log.OFFSET_MASK, 4]),
        frame(bytes_=[8, 0, (log.FETCH_LINE + 1) << log.KIND_BIT, 4]),
        frame([(w.COPY, 2, 0, 0, 0)]),
        frame([(w.ACCESS, 20, 2, 4, 2)]),
        frame([(w.ACCESS, 20, 2, w.LOG_ENTRIES + 1, 0)]),
    ],
    ids=["owner", "site", "offset", "kind", "copy", "call", "room"],
)
def test_what_is_not_there_is_refused(bench: Bench, broken: FrameWork) -> None:
    """A file may hold anything."""
    with pytest.raises(ValueError, match="out of its range"):
        translated(bench, broken)


def test_columns_are_steps() -> None:
    """That go up and down, modulo 2^32."""
    accesses: Accesses = frame().accesses
    assert accesses.stamps.tolist() == [2, 7, 2, 2**32 - 7]
    assert np.cumsum(accesses.places, dtype=np.uint32).tolist() == BYTES
