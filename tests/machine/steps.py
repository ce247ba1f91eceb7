"""Firmware made of steps: each does one thing that cores and devices do."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from hypothesis import strategies as st

from bfsim.api import Core, Frame
from bfsim.machine.program import Main
from tests.machine.kernels import copy, fill, spin, total
from tests.machine.placements import code_in, shipped
from tests.machine.rig import STAGES, Play, every_frame, through_rings

LDFS = {name: shipped(f"{name}.ldf") for name in ("thesis", "l2", "sdram", "cache")} | {
    "code in SDRAM": code_in("SDRAM")
}
Step = tuple[str, int]


def in_and_out(core: Core, frame: Frame, number: int) -> Play:
    """Fetch lines, copy them, and send them back."""
    yield from through_rings(core, frame, copy)


def locked(core: Core, frame: Frame, number: int) -> Play:
    """Work with a lock that the other core may want."""
    yield from core.lock("word")
    yield core.run(spin, number)
    yield from core.unlock("word")


def interrupt_other(core: Core, frame: Frame, number: int) -> Play:
    """Interrupt the other core."""
    yield from core.interrupt_core("B" if core.name == "A" else "A")


def staged(core: Core, frame: Frame, number: int) -> Play:
    """Work in a stage within a stage."""
    with core.stage(STAGES[0]):
        yield core.run(spin, number)
        with core.stage(STAGES[1]):
            yield core.run(total, core.array("in_l2"))


def token(core: Core, frame: Frame, number: int) -> Play:
    """Post a semaphore and take it, or another core's post."""
    yield from core.post("token")
    yield from core.wait("token")


def send_one(core: Core, frame: Frame, number: int) -> Play:
    """Send a row, and do not wait for its arrival."""
    stream = core.output_ring("out_ring", core.rows("image"))
    yield from stream.row()
    stream.send()


def call(*arguments: Any) -> Callable[[Core, Frame, int], Play]:
    """Return what calls a kernel with buffers by name, and with the number of the step for None."""
    kernel, *names = arguments

    def step(core: Core, frame: Frame, number: int) -> Play:
        yield core.run(kernel, *(number if each is None else core.array(each) for each in names))

    return step


THINGS: dict[str, Callable[[Core, Frame, int], Play]] = {
    "spin": call(spin, None),
    "ring": in_and_out,
    "sdram": call(total, "in_sdram"),
    "lock": locked,
    "stage": staged,
    "interrupt": interrupt_other,
    "l2": call(total, "in_l2"),
    "token": token,
    "fill": call(fill, "in_sdram", None),
    "send": send_one,
}
"""What firmware does."""
STEPS = st.lists(st.tuples(st.sampled_from(list(THINGS)), st.integers(0, 300)), max_size=12)


def handler(core: Core) -> Play:
    """An interrupt that takes its time, and a stage of its own."""
    with core.stage(STAGES[1]):
        yield core.run(spin, 50)


def main_of(steps: Sequence[Step], *, handles: bool) -> Main:
    """Make a main loop of steps; at the end of each frame the cores wait for each other."""

    def main(core: Core, frame: Frame) -> Play:
        if handles:
            core.on_interrupt("SUPPLEMENTAL_0", handler)
            core.on_interrupt("MDMA1_0", handler)
        for thing, number in steps:
            yield from THINGS[thing](core, frame, number)
        yield from core.post(core.name)
        yield from core.wait("B" if core.name == "A" else "A")

    return every_frame(main)


EVERYTHING = [(thing, 200) for thing in THINGS]
