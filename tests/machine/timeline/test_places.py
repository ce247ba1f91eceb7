"""What work is about: places of the picture in the timeline, and that they add up to the budget by stage."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from bfsim.api import Core, Frame
from bfsim.errors import FirmwareError
from bfsim.machine.board import Fidelity
from bfsim.machine.core.pictures.places import place_of
from bfsim.report.heat.places import Heats
from bfsim.spans import Place, Span, SpanKind
from tests.machine.kernels import copy, spin
from tests.machine.made_boards import made_board
from tests.machine.rig import SIZE, STAGES, Play, cycles_of, every_frame, run
from tests.machine.steps import EVERYTHING, LDFS, handler, main_of
from tests.machine.timelines import told
from tests.tiers import exhaustive

HEIGHT = SIZE.height_px


def calls(spans: list[Span]) -> list[Place | None]:
    """The places of core A's calls."""
    return [each.place for each in spans if (each.kind, each.where) == (SpanKind.CALL, "core A")]


def row(number: int) -> Place:
    """All of one row."""
    return Place(range(number, number + 1))


def places_of(body: Any, **how: Any) -> list[Place | None]:
    """Return where the calls of a body are, one frame long."""
    _, spans = told(made_board(every_frame(body), **how), frames=1)
    return calls(spans)


@pytest.mark.parametrize("ldf", LDFS)
@pytest.mark.parametrize("fidelity", [Fidelity.FAST, *exhaustive(Fidelity.DETAILED)])
def test_all_places_of_a_stage_together_are_its_budget(ldf: str, fidelity: Fidelity) -> None:
    """To the cycle, under every placement: stalls and waits included, with interrupts between."""
    mains = main_of(EVERYTHING, handles=True), main_of(EVERYTHING[::-1], handles=True)
    outcome, spans = told(made_board(*mains, ldf=LDFS[ldf], fidelity=fidelity))
    heats = Heats()
    heats.add(spans)
    for frame in outcome.frames:
        for core in frame.cores:
            cycles = heats.of(frame.index, f"core {core.core}")
            assert any(place for _, place in cycles)
            for stage in core.stages:
                placed = sum(cclk for (name, _), cclk in cycles.items() if name == stage.stage)
                assert placed == stage.elapsed_cclk


@pytest.mark.parametrize("ldf", ["thesis", "cache"])
def test_work_is_about_the_line_that_a_ring_gave_last(ldf: str) -> None:
    """With DMA or out of a cache, and what a wait for the line costs, too; until the stage ends."""

    def work(core: Core, frame: Frame) -> Play:
        with core.stage(STAGES[0]):
            yield core.run(spin, 1)
            lines = core.input_ring(frame.rows, "in_ring")
            for _ in range(frame.height):
                yield core.run(copy, (yield from lines.line()), core.rows("out_ring")[0])
        yield core.run(spin, 1)

    assert places_of(work, ldf=LDFS[ldf]) == [None, *map(row, range(HEIGHT)), None]


def test_lines_of_a_part_of_the_picture_say_nothing() -> None:
    """Which rows these are only the firmware knows."""

    def work(core: Core, frame: Frame) -> Play:
        lines = core.input_ring(frame.rows[2:], "in_ring")
        yield core.run(copy, (yield from lines.line()), core.rows("out_ring")[0])
        core.at(2)
        yield core.run(spin, 1)

    assert places_of(work) == [None, row(2)]


def test_firmware_says_where_it_is() -> None:
    """Rows, and columns; lines of a ring do not make that less exact; a stage within has its own, and none at first."""

    def work(core: Core, frame: Frame) -> Play:
        lines = core.input_ring(frame.rows, "in_ring")
        core.at(range(1, 3), range(4, 8))
        yield from lines.line()
        yield core.run(spin, 1)
        with core.stage(STAGES[0]):
            yield core.run(spin, 1)
            core.at(5, 6)
            yield core.run(spin, 1)
            core.at(5, sorted, [7, 2, 7])
            yield core.run(spin, 1)
            core.at(5, list)
            yield core.run(spin, 1)
            core.at(lambda: [(6, 2), (5, 7), (6, 2)])
            yield core.run(spin, 1)
            core.at(list)
            yield core.run(spin, 1)
        yield core.run(spin, 1)
        core.at()
        yield core.run(spin, 1)

    box, point = Place(range(1, 3), range(4, 8)), Place(range(5, 6), range(6, 7))
    single, pixels = Place(range(5, 6), (2, 7)), Place((5, 6), (7, 2))
    assert places_of(work) == [box, None, point, single, row(5), pixels, None, box, None]


def test_columns_are_asked_for_only_if_someone_looks() -> None:
    """They may take long to tell."""

    def work(core: Core, _frame: Frame) -> Play:
        core.at(1, lambda: pytest.fail("nobody looks"))
        yield core.run(spin, 1)
        core.at(lambda: pytest.fail("nobody looks"))
        yield core.run(spin, 1)

    run(every_frame(work))


def test_a_handler_is_elsewhere() -> None:
    """What comes between work on a row is not about that row, which goes on behind it."""

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("SUPPLEMENTAL_0", handler)
        core.at(3)
        yield core.run(spin, 20)
        core.request_interrupt("SUPPLEMENTAL_0")
        yield core.run(spin, 21)
        yield core.run(spin, 22)

    _, spans = told(made_board(every_frame(work)), frames=1)
    found = {each.issue_cclk: each.place for each in spans if each.kind is SpanKind.CALL}
    assert found == {cycles_of(spin, 50): None} | {cycles_of(spin, n): row(3) for n in (20, 21, 22)}


@pytest.mark.parametrize(
    ("place", "message"),
    [
        (("x",), "a place of core.at must be in whole pixels, not 'x'"),
        ((2.5, 3), "a place of core.at must be in whole pixels, not 2.5"),
        ((1, lambda: [2, None]), "a place of core.at must be in whole pixels, not None"),
        ((lambda: [(1, 2), (3, 4.5)],), "a place of core.at must be in whole pixels, not 4.5"),
        ((lambda: "abc",), "a pixel of core.at must be a row and a column, not 'a'"),
        ((lambda: [(1, 2, 3)],), r"a pixel of core.at must be a row and a column, not \(1, 2, 3\)"),
    ],
)
def test_what_is_no_place_is_refused(place: Any, message: str) -> None:
    """Where it is said: the heat map, which is drawn much later, ended in a traceback."""
    with pytest.raises(FirmwareError, match=message):
        place_of(*place, *(None,) * (2 - len(place)))


def test_numbers_of_numpy_are_places() -> None:
    """As they stand in buffers."""
    pixels = np.array([[3, 4], [1, 2]], np.uint16)
    assert place_of(lambda: pixels, None) == place_of(lambda: [(1, 2), (3, 4)], None)
    assert place_of(np.int16(3), lambda: pixels[:, 1]) == place_of(3, lambda: [2, 4])
