"""How much each master moved to and from which memory: counted in compiled code, read at the end of a run."""

from __future__ import annotations

from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.masters import NAMED
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.bus.state import State
from bfsim.trace import TrafficRecord

TRAFFIC_SHAPE = w.MAX_OWNERS, w.MASTERS, w.TRAFFIC_WORDS


def traffic_in(words: Any) -> NDArray[np.int64]:
    """Return the traffic in the state `words` of the bus, by owner of the memory, master and counter."""
    counted = np.asarray(words[w.TRAFFIC_AT : w.TRAFFIC_AT + prod(TRAFFIC_SHAPE)], np.int64)
    return counted.reshape(TRAFFIC_SHAPE)


def traffic_records(words: Any, owners: MemoryOwners, cclk_ticks: int) -> tuple[TrafficRecord, ...]:
    """Return the traffic in the state `words` of the bus, by buffer and master. Masters that moved nothing are left out."""
    numbered = sorted(enumerate(owners), key=lambda each: each[1].memory)
    counted = traffic_in(words)[: len(numbered)]
    by_name = {name: counted[:, masters].sum(axis=1).tolist() for name, masters in NAMED.items()}
    records = []
    for number, owner in numbered:
        for name, rows in by_name.items():
            read, written, hits, misses, conflicts, busy = rows[number]
            if read or written:
                records.append(
                    TrafficRecord(
                        memory=owner.memory,
                        buffer=owner.buffer,
                        master=name,
                        read_bytes=read,
                        written_bytes=written,
                        page_hits=hits,
                        page_misses=misses,
                        page_conflicts=conflicts,
                        busy_cclk=busy // cclk_ticks,
                    )
                )
    return tuple(records)


@native
def traffic_at(owner: int, master: int) -> int:
    """Return where the counters of a master's traffic with an owner's memory are."""
    return w.TRAFFIC_AT + (owner * w.MASTERS + master) * w.TRAFFIC_WORDS


@native
def count_traffic(state: State, master: int, owner: int, write: bool, nbytes: int) -> None:
    """Count bytes that a master moved to or from an owner's memory."""
    state[traffic_at(owner, master) + (w.WRITTEN_BYTES if write else w.READ_BYTES)] += nbytes


@native
def count_access(state: State, master: int, owner: int, elements: int, paused: int = 0) -> None:
    """Count `elements` accesses of SDRAM, the first being the controller's last one, and their time without pauses between them."""
    at = traffic_at(owner, master)
    state[at + w.HITS + state[w.PAGE_CLASS]] += 1
    state[at + w.HITS] += elements - 1
    state[at + w.BUSY] += state[w.COMMAND_FREE] - state[w.BEGAN] - state[w.REFRESH_WAIT] - paused


@native
def count_in_l1(state: State, transfer: int, count: int) -> None:
    """Count the next `count` elements of a transfer on its sides in L1."""
    master, nbytes = state[transfer + w.OF_MASTER], count << state[transfer + w.ELEMENT_BITS]
    if state[transfer + w.FROM] >= state[w.L1_FIRST]:
        count_traffic(state, master, state[transfer + w.FROM_OWNER], False, nbytes)
        count_subbanks(state, transfer + w.FROM, count)
    if state[transfer + w.TO] >= state[w.L1_FIRST]:
        count_traffic(state, master, state[transfer + w.TO_OWNER], True, nbytes)
        count_subbanks(state, transfer + w.TO, count)


@native
def count_subbanks(state: State, side: int, count: int) -> None:
    """Count the next `count` elements of a side in L1 for each sub-bank."""
    bits, step = state[w.SUBBANK_BITS], state[side + w.X_MODIFY]
    at, left = state[side + w.POSITION] - state[w.L1_FIRST], count
    while (at + (left - 1) * step) >> bits != at >> bits:
        up_to, end = (at >> bits) << bits, ((at >> bits) + 1) << bits
        here = (end - at + step - 1) // step if step > 0 else (at - up_to) // -step + 1
        state[w.SUBBANKS_AT + (at >> bits)] += here
        at, left = at + here * step, left - here
    state[w.SUBBANKS_AT + (at >> bits)] += left
