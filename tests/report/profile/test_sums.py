"""Every cycle has an owner in every table of the profile: real runs; see also tests/machine/test_every_placement.py."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.run import simulate
from bfsim.trace import BoardRecord, BudgetRow, RunRecord
from tests.machine.made_boards import play
from tests.machine.rig import STAGES
from tests.machine.steps import LDFS, STEPS, Step, main_of
from tests.report.profile_sums import assert_profile_adds_up
from tests.report.records import IDENTITY, run_of


def run_from(outcome: BoardRecord) -> RunRecord:
    """The records of a board's run; the second stage is a part of the first."""
    return replace(
        run_of(outcome.frames),
        identity=replace(IDENTITY, cclk_hz=600e6),
        rows=(BudgetRow(stage=STAGES[0]), BudgetRow(stage=STAGES[1], within=STAGES[0])),
        kernels=outcome.kernels,
        accesses=outcome.accesses,
        paths=outcome.paths,
        buffers=outcome.buffers,
        traffic=outcome.traffic,
    )


@given(STEPS, STEPS, st.booleans(), st.sampled_from(list(LDFS)), st.integers(1, 3))
@settings(max_examples=15, deadline=None)
def test_rows_of_chance_firmware_add_up(
    of_a: list[Step], of_b: list[Step], handles: bool, ldf: str, frames: int
) -> None:
    """Whatever the cores do, and in whichever order they meet."""
    mains = main_of(of_a, handles=handles), main_of(of_b, handles=handles)
    assert_profile_adds_up(run_from(play(*mains, frames=frames, ldf=LDFS[ldf])))


@pytest.mark.exhaustive
@pytest.mark.parametrize("ldf", ["thesis", "l2", "sdram", "cache"])
def test_rows_of_the_built_in_firmware_add_up(ldf: str) -> None:
    """Two frames of the built-in recording, with the start-up told apart."""
    assert_profile_adds_up(simulate(ldf=Path(ldf), frames=2))
