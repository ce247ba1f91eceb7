"""A device that sets the pace, a camera or the SPI: when its elements are there, and what is lost when a DMA comes late."""

from __future__ import annotations

from bfsim.kernel.compiled import compiled
from bfsim.machine.bus import state as w
from bfsim.machine.bus.state import Memory, State
from bfsim.machine.bus.walk import copy_element, go_on


@compiled
def aligned(tick: int, period: int) -> int:
    """Return the first edge of a clock of `period` ticks at or after `tick`."""
    return (tick + period - 1) // period * period


@compiled
def arrival(state: State, slot: int, ahead: int) -> int:
    """Return when a device has the element `ahead` of the next one, or has sent it: the end of its time on the wire."""
    place, began = state[slot + w.PLACE] + ahead, state[slot + w.LINE_BEGAN]
    while place >= state[slot + w.LINE_ELEMENTS]:
        place -= state[slot + w.LINE_ELEMENTS]
        began += state[slot + w.LINE]
    while place < 0:
        place += state[slot + w.LINE_ELEMENTS]
        began -= state[slot + w.LINE]
    ticks, parts = began + (place + 1) * state[slot + w.ELEMENT], state[slot + w.PARTS]
    if parts > 1:
        ticks = (ticks + parts - 1) // parts
    return state[slot + w.START] + ticks


@compiled
def step_device(state: State, slot: int, count: int) -> None:
    """Go on by `count` elements of the device's line."""
    state[slot + w.PLACE] += count
    if state[slot + w.PLACE] == state[slot + w.LINE_ELEMENTS]:
        state[slot + w.PLACE] = 0
        state[slot + w.LINE_BEGAN] += state[slot + w.LINE]


@compiled
def lot_of(state: State, slot: int) -> int:
    """How many elements a device's DMA moves at once: each as it comes in, but half a FIFO on its way out.

    So the other half is there while the DMA waits for the bus.
    """
    if state[slot + w.MODE] == w.PACED_IN:
        return 1
    left = min(state[slot + w.FROM_X_LEFT], state[slot + w.TO_X_LEFT])
    return min(max(1, state[w.LOT] // 2), left, state[slot + w.LINE_ELEMENTS] - state[slot + w.PLACE])


@compiled
def next_paced(state: State, master: int, slot: int) -> None:
    """Set when the device's next lot wants to move: when it is there, or when the FIFO has room for it."""
    lot, ready = lot_of(state, slot), state[slot + w.START]
    if state[slot + w.MODE] == w.PACED_IN:
        ready = arrival(state, slot, lot - 1)
    elif state[slot + w.MOVED] >= state[master + w.FIFO]:
        ready = arrival(state, slot, lot - 1 - state[master + w.FIFO])
    state[master + w.READY] = aligned(ready, state[w.SCLK])


@compiled
def lose(state: State, memory: Memory, master: int, slot: int, at: int) -> None:
    """Drop the elements that came before tick `at` and found the FIFO full; the picture goes on without them.

    Those in the FIFO take the places of the last ones dropped, where the device's memory is read next.
    """
    fifo, lost = state[master + w.FIFO], 0
    while state[slot + w.LEFT] > fifo + lost and arrival(state, slot, fifo + lost) < at:
        lost += 1
    if lost == 0:
        return
    first, step = state[slot + w.FROM], state[slot + w.FROM_X_MODIFY]
    for element in range(fifo - 1, -1, -1):
        copy_element(
            memory, first + element * step, first + (element + lost) * step, state[slot + w.ELEMENT_BITS]
        )
    for _ in range(lost):
        go_on(state, slot + w.FROM, 1)
        step_device(state, slot, 1)
    state[slot + w.MOVED] += lost
    state[slot + w.LEFT] -= lost
    state[slot + w.LOST] += lost
    state[master + w.ALL_LOST] += lost
