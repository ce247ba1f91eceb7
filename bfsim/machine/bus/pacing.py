"""A device that sets the pace, such as a camera or the SPI: when its elements are there, and what is lost if a DMA is late."""

from __future__ import annotations

from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.state import Memory, State
from bfsim.machine.bus.walk import copy_element, go_on


@native
def aligned(tick: int, period: int) -> int:
    """Return the first edge of a clock of `period` ticks at or after `tick`."""
    return (tick + period - 1) // period * period


@native
def arrival(state: State, transfer: int, ahead: int) -> int:
    """Return when a device has received or sent the element `ahead` elements after the next one: the end of its time on the wire."""
    place, began = state[transfer + w.PLACE] + ahead, state[transfer + w.LINE_BEGAN]
    while place >= state[transfer + w.LINE_ELEMENTS]:
        place -= state[transfer + w.LINE_ELEMENTS]
        began += state[transfer + w.LINE]
    while place < 0:
        place += state[transfer + w.LINE_ELEMENTS]
        began -= state[transfer + w.LINE]
    ticks, parts = began + (place + 1) * state[transfer + w.ELEMENT], state[transfer + w.PARTS]
    if parts > 1:
        ticks = (ticks + parts - 1) // parts
    return state[transfer + w.START] + ticks


@native
def step_device(state: State, transfer: int, count: int) -> None:
    """Advance by `count` elements of the device's line."""
    state[transfer + w.PLACE] += count
    if state[transfer + w.PLACE] == state[transfer + w.LINE_ELEMENTS]:
        state[transfer + w.PLACE] = 0
        state[transfer + w.LINE_BEGAN] += state[transfer + w.LINE]


@native
def burst_of(state: State, transfer: int) -> int:
    """Return how many elements a device's DMA moves at once: one on the way in, but half a FIFO on the way out.

    The other half is there while the DMA waits for the bus.
    """
    if state[transfer + w.MODE] == w.PACED_IN:
        return 1
    left = min(state[transfer + w.FROM_X_LEFT], state[transfer + w.TO_X_LEFT])
    return min(
        max(1, state[w.BURST_WORDS] // 2), left, state[transfer + w.LINE_ELEMENTS] - state[transfer + w.PLACE]
    )


@native
def next_paced(state: State, master: int, transfer: int) -> None:
    """Set when the device's next burst can move: when it is there, or when the FIFO has room for it."""
    burst, ready = burst_of(state, transfer), state[transfer + w.START]
    if state[transfer + w.MODE] == w.PACED_IN:
        ready = arrival(state, transfer, burst - 1)
    elif state[transfer + w.MOVED] >= state[master + w.FIFO]:
        ready = arrival(state, transfer, burst - 1 - state[master + w.FIFO])
    state[master + w.READY] = aligned(ready, state[w.SCLK])


@native
def lose(state: State, memory: Memory, master: int, transfer: int, at: int) -> None:
    """Drop the elements that came before tick `at` and found the FIFO full. The picture goes on without them.

    Elements in the FIFO take the places of the last dropped ones, where the device's memory is read next.
    """
    fifo, lost = state[master + w.FIFO], 0
    while state[transfer + w.LEFT] > fifo + lost and arrival(state, transfer, fifo + lost) < at:
        lost += 1
    if lost == 0:
        return
    first, step = state[transfer + w.FROM], state[transfer + w.FROM_X_MODIFY]
    for element in range(fifo - 1, -1, -1):
        copy_element(
            memory, first + element * step, first + (element + lost) * step, state[transfer + w.ELEMENT_BITS]
        )
    for _ in range(lost):
        go_on(state, transfer + w.FROM, 1)
        step_device(state, transfer, 1)
    state[transfer + w.MOVED] += lost
    state[transfer + w.LEFT] -= lost
    state[transfer + w.LOST] += lost
    state[master + w.ALL_LOST] += lost
