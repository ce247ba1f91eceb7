"""Which arrays the accesses of object code are to: as followed through the code, and as the addresses of calls say."""

from __future__ import annotations

from collections import Counter
from functools import cache

import numpy as np
import pytest

from bfsim.blackfin.instructions.decode import decode
from bfsim.blackfin.instructions.origins import Origin, made_by
from bfsim.blackfin.translation.room import SUMS
from bfsim.kernel import Kernel
from bfsim.kernel.build import Build
from bfsim.kernel.calls.access_log import KIND_BIT, KIND_MASK, LOG, STORE
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.kernel.profile import DEFAULT
from bfsim.loading.firmware import load_firmware
from bfsim.loading.kernels import entries_of
from bfsim.run import simulate
from bfsim.running.building import build_for
from bfsim.shipped import FIRMWARE
from bfsim.verifying import Sampler

KERNELS = ("suppress_row", "gauss3_row", "connect_near", "segment_row")
"""Rows of arguments on the stack, spilled pointers, differences of pointers as indices."""


@cache
def built() -> Build:
    """The built-in firmware by GCC's code."""
    return build_for(load_firmware(FIRMWARE[0]), DEFAULT)


@pytest.fixture(scope="module")
def sampler() -> Sampler:
    """A few calls of each kernel in a frame."""
    found = Sampler(4)
    simulate(frames=1, on_call=found.see)
    return found


@pytest.mark.parametrize("name", KERNELS)
def test_accesses_are_to_the_arrays_that_they_hit(name: str, sampler: Sampler) -> None:
    """Each array is read and written as often as the addresses of the calls say."""
    kernel = next(each for each in entries_of(load_firmware(FIRMWARE[0]).firmware) if each.name == name)
    for arguments in sampler.of[kernel].kept:
        assert _expected(kernel, arguments) == _hit(kernel, arguments) != {}


def _expected(kernel: Kernel, arguments: tuple) -> Counter:
    code = built().compiled(kernel)
    totals = code.new_totals()
    arrays = [np.array(arguments[each]) for each in kernel.array_positions]
    kernel.prepare(code, arrays, totals).run(*arguments)
    found: Counter = Counter()
    for events, counter in zip(totals[:-SUMS].tolist(), code.counters, strict=True):
        for each in counter.accesses:
            found[each.array, each.writes] += each.times(events)
    return +found


def _hit(kernel: Kernel, arguments: tuple) -> Counter:
    """Run it with all arrays in memory that is followed; a site stands for a line and an array."""
    code = built().compiled(kernel, traced=True)
    arena = np.zeros(1 << 20, np.uint8)
    arrays, at = [], 0
    for each in (np.array(arguments[each]) for each in kernel.array_positions):
        place = arena[at : at + each.nbytes].view(each.dtype)
        place[:] = each
        arrays.append(place)
        at += -(-each.nbytes // 64) * 64
    trace = AccessTrace(arena, len(arena), np.zeros(LOG + (1 << 20), np.int64))
    work = kernel.prepare(code, arrays, code.new_totals(), trace).run(*arguments)
    sites = code.program.sites
    entries = zip(trace.entries(work.accesses).tolist(), trace.sites(work.accesses).tolist(), strict=True)
    return Counter((sites[site].array, entry >> KIND_BIT & KIND_MASK == STORE) for entry, site in entries)


def test_an_instruction_knows_the_origins_of_what_it_makes() -> None:
    """P1 = P2 + P3; R0 = R1 - R2; R3 = [FP + -8]; P1 = -148; R0 <<= 1: of sums both, of differences one less the other, of loads
    the word, of a number that, and of twice a number no sum."""
    added = made_by(decode(bytes.fromhex("5a5a"), 0)).writes["P1"]
    assert added == Origin(frozenset({"P2", "P3"}), terms=("P2", "P3"))
    number = made_by(decode(bytes.fromhex("29e16cff"), 0)).writes["P1"]
    assert number == Origin(terms=(), offset=-148)
    doubled = made_by(decode(bytes.fromhex("084f"), 0)).writes["R0"]
    assert doubled == Origin(frozenset({"R0"}))
    less = made_by(decode(bytes.fromhex("1152"), 0)).writes["R0"]
    assert (less.of, less.less) == ({"R1"}, {"R2"})
    loaded = made_by(decode(bytes.fromhex("e3b9"), 0))
    assert loaded.writes["R3"] == Origin(frozenset({"load 0"}), terms=("load 0",))
    assert (loaded.accesses[0].address.base, loaded.accesses[0].address.offset) == ("FP", -8)
