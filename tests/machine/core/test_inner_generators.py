"""Generators of firmware that wait for others: what these return and raise comes out of them as Python has it, though machine code goes on with them."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import pytest

from bfsim.api import Core, Frame
from bfsim.errors import FirmwareError
from tests.machine.kernels import first
from tests.machine.rig import Play, every_frame, run

CALLS = 100
"""Enough that machine code makes most of them."""
FRAMES = 4
"""Machine code makes the calls from the second picture on."""


def begun(core: Core, frame: Frame) -> Play:
    """Take a line by DMA, so that there is something that calls are noted behind."""
    yield from core.input_ring(frame.rows, "in_ring").line()


def summed(core: Core, calls: int) -> Generator[Any, Any, int]:
    """Return the sum of what so many calls give."""
    total = 0
    for _ in range(calls):
        total += yield core.run(first, core.array("single_row"))
    return total


def nested(core: Core, depth: int, calls: int) -> Generator[Any, Any, tuple[int, ...]]:
    """Return what calls give in each of so many generators, one in the other, the innermost one first."""
    inside = (yield from nested(core, depth - 1, calls)) if depth else ()
    return *inside, (yield from summed(core, calls))


@pytest.mark.parametrize("depth", [0, 3, 40])
def test_what_is_returned_comes_out(depth: int) -> None:
    """Out of many generators, too."""
    given: list[tuple[int, ...]] = []

    def work(core: Core, frame: Frame) -> Play:
        yield from begun(core, frame)
        core.array("single_row").array[0] = 7
        given.append((yield from nested(core, depth, CALLS)))

    run(every_frame(work), frames=FRAMES)
    assert given == FRAMES * [(1 + depth) * (7 * CALLS,)]


def failing(core: Core) -> Generator[Any, Any, int]:
    """Fail after some calls."""
    yield from summed(core, CALLS)
    raise LookupError("not there")


def between(core: Core, said: list[str]) -> Generator[Any, Any, int]:
    """Say that it was left."""
    try:
        return (yield from failing(core))
    finally:
        said.append("left")


def test_what_is_raised_comes_out() -> None:
    """Each generator around has its turn with it, and the one that handles it goes on."""
    said: list[str] = []

    def work(core: Core, frame: Frame) -> Play:
        yield from begun(core, frame)
        try:
            yield from between(core, said)
        except LookupError as error:
            said.append(f"{error} {frame.index}")
        said.append(str((yield from summed(core, 3))))

    run(every_frame(work), frames=FRAMES)
    assert said == [each for index in range(FRAMES) for each in ("left", f"not there {index}", "0")]


def test_the_innermost_line_of_what_nobody_handles_is_told() -> None:
    """It is where the firmware failed, in the fourth picture."""

    def work(core: Core, frame: Frame) -> Play:
        yield from begun(core, frame)
        yield from between(core, []) if frame.index == FRAMES - 1 else summed(core, CALLS)

    line = failing.__code__.co_firstlineno + 3
    with pytest.raises(FirmwareError, match=rf"LookupError: not there \({__file__}:{line}\)"):
        run(every_frame(work), frames=FRAMES)
