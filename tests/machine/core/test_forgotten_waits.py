"""Waits that firmware never begins, for lack of a `yield from`: each is told with its line."""

from __future__ import annotations

from typing import Any

import pytest

from bfsim.api import Core, Frame
from bfsim.errors import FirmwareError
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


@pytest.mark.parametrize(
    ("body", "name", "line"),
    [(forgotten_post, "post", 2), (forgotten_flush, "flush", 3), (forgotten_dma, "wait", 2)],
)
def test_a_wait_that_is_never_begun_is_told_with_its_line(body: Any, name: str, line: int) -> None:
    """Python runs nothing of it and says nothing; it is noticed when the next frame is asked for."""
    place = f"{__file__}:{body.__code__.co_firstlineno + line}"
    with pytest.raises(FirmwareError) as caught:
        run(every_frame(body))
    told = f"core A: {name}(...) at {place} does nothing: write `yield from` before it; noticed ("
    assert str(caught.value).startswith(told)


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
