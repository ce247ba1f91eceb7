"""The compiled part of the access trace: called by a kernel's machine code at every access that may leave L1."""

from __future__ import annotations

from collections.abc import MutableSequence

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native, native_entry, words_at

State = MutableSequence[int]


@native
def write_entry(state: State, kind: int, offset: int, stamp: int, site: int) -> None:
    """Log an access of a site, or only count it when the log is full."""
    if state[log.ENTRIES] < state[log.ROOM]:
        at = log.LOG + state[log.ENTRIES]
        state[at] = stamp << log.STAMP_BIT | kind << log.KIND_BIT | offset
        state[at + state[log.ROOM]] = site
    state[log.ENTRIES] += 1


@native
def policy_of(state: State, offset: int) -> int:
    """Return how the region at `offset` is cached, or EMPTY."""
    for number in range(state[log.REGIONS]):
        at = log.FIRST_REGION + 3 * number
        if state[at] <= offset < state[at + 1]:
            return state[at + 2]
    return log.EMPTY


@native
def look_up(state: State, line: int, changed: int, allocate: bool) -> tuple[bool, int]:
    """Look for a line and make it the one used last; return whether it was there, and the changed line that it replaced."""
    first, way = log.TAGS + line % state[log.SETS] * state[log.WAYS], 0
    last = state[log.WAYS] - 1
    while way < last and state[first + way] >> 1 != line:
        way += 1
    hit = state[first + way] >> 1 == line
    if not hit and not allocate:
        return False, log.EMPTY
    if not hit:  # an empty way is taken before the one used longest ago
        way = 0
        while way < last and state[first + way] != log.EMPTY:
            way += 1
    tag = state[first + way]
    left = tag >> 1 if not hit and tag != log.EMPTY and tag & 1 else log.EMPTY
    while way > 0:
        state[first + way] = state[first + way - 1]
        way -= 1
    state[first] = (tag if hit else line << 1) | changed
    return hit, left


@native
def trace_cached(state: State, offset: int, write: bool, policy: int, stamp: int, site: int) -> None:
    """Log what the data cache asks of the memories for an access."""
    bits, changes = state[log.LINE_BITS], write and policy == log.WRITE_BACK_POLICY
    hit, left = look_up(state, offset >> bits, 1 if changes else 0, changes or not write)
    if left != log.EMPTY:
        write_entry(state, log.WRITE_BACK, left << bits, stamp, site)
    if write and not changes:
        write_entry(state, log.STORE, offset, stamp, site)
    elif not hit:
        write_entry(state, log.FILL, offset >> bits << bits, stamp, site)


@native_entry("void", "int64*", "int64", "int64", "int64", "int64")
def trace_access(at: State, address: int, access: int, stamp: int, site: int) -> None:
    """Trace an access of `access` bytes, WRITE more if it writes, at a host address and a cycle of the call, made by `site`."""
    state = words_at(at)
    if not state[log.ARENA] <= address < state[log.END]:
        return
    write, offset = access >= log.WRITE, address - state[log.ARENA]
    if not state[log.REGIONS]:  # most boards cache nothing: then no register need be saved
        write_entry(state, log.STORE if write else log.LOAD, offset, stamp, site)
        return
    policy = policy_of(state, offset)
    if policy == log.EMPTY:
        write_entry(state, log.STORE if write else log.LOAD, offset, stamp, site)
    else:
        trace_cached(state, offset, write, policy, stamp, site)
