"""How long a sweep takes, by what is known of its points."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from bfsim.sweeping.pace import Pace
from bfsim.sweeping.planned import Planned
from bfsim.sweeping.running import Outcome
from tests.sweeping.rig import home_in, planned


@pytest.fixture
def point(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Planned:
    """A planned point of two frames."""
    monkeypatch.chdir(tmp_path)
    home_in(tmp_path)
    return next(each for each in planned(Path("what-if.toml")).planned if each.frames == 2)


def of(point: Planned, ldf: str) -> Planned:
    """The same with another LDF."""
    assert point.identity
    return replace(point, identity=replace(point.identity, ldf_digest=ldf))


def test_each_kind_has_a_pace_of_its_own(point: Planned) -> None:
    """A sweep of two LDFs was told half of what it took, by its first point."""
    pace, slow, other = Pace(), of(point, "slow"), of(point, "other")
    assert pace.seconds_left([point], 1) is None
    pace.add(point, Outcome(frames=2, seconds=1))
    assert pace.unknown([slow, point, other, slow]) == [slow, other]
    pace.add(slow, Outcome(frames=1, seconds=2.5))  # half of it
    assert pace.unknown([point, slow, other]) == [other]
    assert pace.seconds_left([point, slow, slow, slow], 1) == pytest.approx(1 + 3 * 5)
    assert pace.seconds_left([point, slow, slow, slow], 2) == pytest.approx(8)
    assert pace.seconds_left([other], 4) == pytest.approx(2 * 3.5 / 3), "nothing is known: as all of them"
    assert pace.seconds_left([], 2) == 0


def test_of_a_point_that_failed_nothing_is_learnt(point: Planned) -> None:
    """And it is tried no second time for that."""
    pace = Pace()
    pace.add(point, Outcome(error="no"))
    assert pace.seconds_left([point], 1) is None
