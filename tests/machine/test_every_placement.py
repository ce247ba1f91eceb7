"""Firmware that does everything, under every placement, feed and fidelity: one run of each, and all that must hold of it."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest

from bfsim.machine.board import Board, Fidelity
from bfsim.machine.cameras.capture import Feed
from bfsim.spans import Span
from bfsim.trace import BoardRecord
from tests.machine.made_boards import made_board
from tests.machine.owners import assert_owned
from tests.machine.rig import noise
from tests.machine.steps import EVERYTHING, LDFS, main_of
from tests.machine.timelines import assert_flows, assert_orderly, assert_tiled, told
from tests.report.profile.test_sums import run_from
from tests.report.profile_sums import assert_profile_adds_up

FRAMES = 3
Configuration = tuple[str, Feed, Fidelity]
Told = tuple[Configuration, BoardRecord, list[Span]]


def board_of(configuration: Configuration) -> Board:
    """A board with rings, locks, semaphores, interrupts, stages within stages, and kernels in every memory."""
    ldf, feed, fidelity = configuration
    mains = main_of(EVERYTHING, handles=True), main_of(EVERYTHING[::-1], handles=True)
    return made_board(*mains, ldf=LDFS[ldf], feed=feed, fidelity=fidelity)


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(each, marks=pytest.mark.exhaustive if each[2] is Fidelity.DETAILED else ())
        for each in product(LDFS, Feed, Fidelity)
    ],
    ids=lambda each: "-".join(map(str, each)),
)
def run(request: Any) -> Told:
    """Its records and its timeline."""
    outcome, spans = told(board_of(request.param), FRAMES)
    assert len(outcome.frames) == FRAMES
    return request.param, outcome, spans


def test_spans_fill_the_time_of_a_core_and_add_up_to_its_budget(run: Told) -> None:
    """To the cycle, by stage: issue, every reason of a stall, and idle."""
    _, outcome, spans = run
    assert_orderly(spans)
    assert_tiled(outcome.frames, spans)
    assert_flows(spans)


def test_a_run_without_a_timeline_is_the_same(run: Told) -> None:
    """Telling changes nothing."""
    configuration, outcome, _ = run
    board = board_of(configuration)
    assert board.run(noise(FRAMES, board.size)) == outcome


def test_owners_fill_every_stage(run: Told) -> None:
    """Each cycle is a kernel's, or something's that no kernel does: the sums are exact."""
    assert_owned(run[1])


def test_rows_of_the_profile_add_up(run: Told) -> None:
    """In every table, of every core and stage."""
    assert_profile_adds_up(run_from(run[1]))
