"""A core that runs ahead tells of itself what one in step with the simulated time tells."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import Core, Frame
from bfsim.machine.board import Board
from bfsim.spans import Span, SpanKind
from tests.machine.kernels import copy, spin, total
from tests.machine.made_boards import in_work, made_board
from tests.machine.rig import Play
from tests.machine.steps import LDFS, STEPS, Step, main_of
from tests.machine.timelines import assert_flows, by_track, told


def both(board: Board, other: Board, frames: int = 2) -> tuple[list[Span], list[Span]]:
    """The timelines of two boards with the same firmware, whose cores run ahead, and whose cores are in step; the records are the same."""
    other.ahead = None
    (ahead, told_ahead), (in_step, told_in_step) = told(board, frames), told(other, frames)
    assert replace(ahead, events=0) == replace(in_step, events=0)
    return told_ahead, told_in_step


def without_levels(spans: list[Span]) -> dict[tuple[str, str], list[Span]]:
    """Spans by track, with whether they have a flow: its number says when a transfer was posted. Levels of a bus are of other times."""
    tracks = by_track(each._replace(flow=bool(each.flow)) for each in spans)
    return {track: each for track, each in tracks.items() if each[0].kind is not SpanKind.LEVEL}


@given(STEPS, STEPS, st.booleans(), st.sampled_from(list(LDFS)))
@settings(max_examples=25, deadline=None)
def test_what_is_told_later_is_what_is_told_at_once(
    steps_a: list[Step], steps_b: list[Step], b_handles: bool, ldf: str
) -> None:
    """Calls, waits, stages, transfers, places: each at its cycle, whatever the cores do."""
    mains = main_of(steps_a, handles=False), main_of(steps_b, handles=b_handles)
    ahead, in_step = both(made_board(*mains, ldf=LDFS[ldf]), made_board(*mains, ldf=LDFS[ldf]))
    assert without_levels(ahead) == without_levels(in_step)
    assert_flows(ahead)


def test_places_and_stages_are_those_of_the_firmware_then() -> None:
    """Though it is far ahead when they are told: it has left the stage, and works on another row."""

    def work(core: Core, frame: Frame) -> Play:
        out = core.output_ring("out_ring", core.rows("image"))
        lines = core.input_ring(frame.rows, "in_ring")
        for number in range(frame.height):
            yield core.run(copy, (yield from lines.line()), (row := (yield from out.row())))
            core.at(number, lambda number=number: [number, 0])
            yield core.run(spin, number)
            yield core.run(total, core.array("in_sdram"))
            out.send()
            assert row
        yield from out.flush()

    ahead, in_step = both(made_board(in_work(work)), made_board(in_work(work)))
    assert without_levels(ahead) == without_levels(in_step)
    assert len({each.place for each in ahead if each.kind is SpanKind.CALL}) > 5
    assert {each.stage for each in ahead if each.name == "spin"} == {"Work"}


@pytest.mark.parametrize(("cycles", "most"), [(20_000, 1), (1, 2)])
def test_lines_on_their_way_are_those_whose_copies_are_not_over(cycles: int, most: int) -> None:
    """Of slow work each line has arrived before the next one is sent; of fast work two wait for their DMA."""

    def send(core: Core, frame: Frame) -> Play:
        out = core.output_ring("out_ring", core.rows("image"))
        for _ in range(frame.height):
            yield from out.row()
            yield core.run(spin, cycles)
            out.send()
        yield from out.flush()

    _, spans = told(made_board(in_work(send)), frames=1)
    fills = by_track(spans)["core A", "ring out_ring"]
    assert max(each.value for each in fills) == most
