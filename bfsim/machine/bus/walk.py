"""How a transfer walks through memory: the next elements of both sides, and the moving of their bytes."""

from __future__ import annotations

from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.state import Memory, State

WORD_BYTES, WORD_BITS = 4, 2  # the arena is an array of 32-bit words


@native
def go_on(state: State, side: int, count: int) -> None:
    """Move a side on by `count` elements of its line. After the last element of a line, Y_MODIFY replaces X_MODIFY."""
    state[side + w.POSITION] += count * state[side + w.X_MODIFY]
    state[side + w.X_LEFT] -= count
    if state[side + w.X_LEFT] == 0:
        state[side + w.POSITION] += state[side + w.Y_MODIFY] - state[side + w.X_MODIFY]
        state[side + w.X_LEFT] = state[side + w.X_COUNT]


@native
def copy_element(memory: Memory, source: int, target: int, bits: int) -> None:
    """Copy the element of 1 << `bits` bytes at `source` to `target`."""
    if bits == WORD_BITS:
        memory[target >> WORD_BITS] = memory[source >> WORD_BITS]
        return
    mask, shift = (1 << (8 << bits)) - 1, target % WORD_BYTES * 8
    value = memory[source >> WORD_BITS] >> (source % WORD_BYTES * 8) & mask
    memory[target >> WORD_BITS] = memory[target >> WORD_BITS] & ~(mask << shift) | value << shift


@native
def move(state: State, memory: Memory, transfer: int, count: int) -> None:
    """Move `count` elements, none beyond the end of either side's line, and move both sides on."""
    if not state[transfer + w.IS_MOVED]:
        move_bytes(state, memory, transfer, count)
    go_on(state, transfer + w.FROM, count)
    go_on(state, transfer + w.TO, count)
    state[transfer + w.MOVED] += count
    state[transfer + w.LEFT] -= count


@native
def move_bytes(state: State, memory: Memory, transfer: int, count: int) -> None:
    """Move the bytes of the next `count` elements."""
    source, target, bits = state[transfer + w.FROM], state[transfer + w.TO], state[transfer + w.ELEMENT_BITS]
    source_step, target_step = state[transfer + w.FROM_X_MODIFY], state[transfer + w.TO_X_MODIFY]
    if bits == WORD_BITS and source_step == target_step == WORD_BYTES:
        source, target = source >> WORD_BITS, target >> WORD_BITS
        for word in range(count):
            memory[target + word] = memory[source + word]
    else:
        for _ in range(count):
            copy_element(memory, source, target, bits)
            source += source_step
            target += target_step
