"""Waits and stages that firmware never begins, for lack of a `yield from` or a `with`: each is told with its line."""

from __future__ import annotations

import inspect
from typing import Any

import pytest

from bfsim.api import Core, Frame
from bfsim.errors import DeadlockError, FirmwareError
from bfsim.linker import parse_ldf
from bfsim.shipped import LDF_FOLDER
from tests.machine.kernels import first, spin
from tests.machine.rig import Play, every_frame, run, see_all


def forgotten_post(core: Core, frame: Frame) -> Play:
    """Nobody is told."""
    core.post("go")
    yield core.run(spin, 1)


def forgotten_flush(core: Core, frame: Frame) -> Play:
    """The last lines may not have arrived."""
    out = core.output_ring("out_ring", core.rows("image"))
    out.flush()
    yield core.run(spin, 1)


def forgotten_dma(core: Core, frame: Frame) -> Play:
    """The DMA is not awaited."""
    core.memory_dma("MDMA1_0").wait()
    yield core.run(spin, 1)


def forgotten_line(core: Core, frame: Frame) -> Play:
    """The core works on the same line again and again."""
    ring = core.input_ring(frame.rows, "in_ring")
    row = yield from ring.line()
    ring.line()
    yield core.run(first, row)


def kept_line(core: Core, frame: Frame) -> Play:
    """It lives on, and is no row."""
    ring = core.input_ring(frame.rows, "in_ring")
    rows = [ring.line()]
    yield core.run(spin, len(rows))


def forgotten_row(core: Core, frame: Frame) -> Play:
    """The first line of `image` is sent as it was."""
    out = core.output_ring("out_ring", core.rows("image"))
    out.row()
    out.send()
    yield from out.flush()


@pytest.mark.parametrize(
    ("body", "name", "line"),
    [
        (forgotten_post, "post", 2),
        (forgotten_flush, "flush", 3),
        (forgotten_dma, "wait", 2),
        (forgotten_line, "line", 4),
        (kept_line, "line", 3),
        (forgotten_row, "row", 3),
    ],
)
def test_a_wait_that_is_never_begun_is_told_with_its_line(body: Any, name: str, line: int) -> None:
    """Python runs nothing of it and says nothing; it is noticed when the next frame is asked for."""
    place = f"{__file__}:{body.__code__.co_firstlineno + line}"
    with pytest.raises(FirmwareError) as caught:
        run(every_frame(body))
    told = f"core A: {name}(...) at {place} does nothing: write `yield from` before it; noticed ("
    assert str(caught.value).startswith(told)


def waiting(core: Core, frame: Frame) -> Play:
    """For what the other core never says."""
    yield from core.wait("go")


def posting(core: Core, frame: Frame) -> Play:
    """So that no next frame is asked for, where it would be noticed."""
    core.post("go")
    yield from core.wait("went")


def test_cores_that_block_each_other_for_lack_of_it_are_told_so() -> None:
    """Without `yield from` before a post, the other core waits for ever, and often this one for it."""
    place = f"{__file__}:{posting.__code__.co_firstlineno + 2}"
    with pytest.raises(DeadlockError) as caught:
        run(every_frame(waiting), every_frame(posting))
    told = f"; core B: post(...) at {place} does nothing: write `yield from` before it"
    assert str(caught.value).endswith(told)


@pytest.mark.parametrize("ldf", ["thesis", "cache"])
@pytest.mark.parametrize("body", [forgotten_line, forgotten_row])
def test_lines_of_pictures_in_cached_memory_are_told_of_as_well(body: Any, ldf: str) -> None:
    """The rings are the pictures themselves there."""
    with pytest.raises(FirmwareError, match=r"core A: (line|row)\(\.\.\.\) at .* does nothing: "):
        run(every_frame(body), ldf=parse_ldf(LDF_FOLDER / f"{ldf}.ldf"))


def test_a_stage_without_with_is_told() -> None:
    """What follows it would be charged to no stage."""

    def body(core: Core, frame: Frame) -> Play:
        core.stage("Work")
        yield core.run(spin, 1)

    line = body.__code__.co_firstlineno + 1
    told = rf"core A: stage\(\.\.\.\) at .*:{line} does nothing: write `with` before it; noticed"
    with pytest.raises(FirmwareError, match=told):
        run(every_frame(body))


def test_many_lines_are_looked_at_in_the_first_picture_alone() -> None:
    """Later ones cost no time for it: machine code is what firmware calls."""
    hurry = []

    def body(core: Core, frame: Frame) -> Play:
        ring = core.input_ring(frame.rows, "in_ring")
        hurry.append(inspect.isbuiltin(ring.line))
        yield from ring.line()

    run(every_frame(body), frames=3)
    assert hurry == [False, True, True]


def test_a_wait_that_is_never_begun_is_told_at_the_end_of_all() -> None:
    """Behind the last frame."""

    def main(core: Core) -> Play:
        yield from see_all(core)
        core.post("over")

    with pytest.raises(
        FirmwareError, match=r"post\(\.\.\.\) at .* does nothing: .*; noticed at the end of main"
    ):
        run(main)


@pytest.mark.parametrize("inside", [True, False])
def test_a_frame_that_is_not_waited_for_is_told(inside: bool) -> None:
    """A loop around it would never end; the picture has no rows."""

    def main(core: Core) -> Play:
        while frame := core.next_frame():
            if inside:
                yield core.run(first, frame.rows[0])  # type: ignore[attr-defined]

    with pytest.raises(
        FirmwareError, match=r"core A: next_frame\(\.\.\.\) at .* write `yield from` before it"
    ):
        run(main)
