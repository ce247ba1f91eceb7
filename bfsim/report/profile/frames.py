"""The worst frames, and how they differ from the median frame: stage by stage, owner by owner."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from bfsim.report.budget.start_up import without_start_up
from bfsim.report.budget.waits import busy_cclk
from bfsim.report.profile.costs import cores_of, stages_in
from bfsim.trace import FrameRecord, OwnerCost, RunRecord

WORK = "work"


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnerDifference:
    """By how many calls and cycles an owner differs from the median frame; `why` is the kind that differs most."""

    stage: str
    owner: str
    calls: int
    cclk: int
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameProfile:
    """A frame: its cycles without idling and waits for the other core, and their difference from the median frame.

    The difference is also split by stages and owners, the greatest first.
    """

    index: int
    cclk: int
    difference_cclk: int
    stages: tuple[tuple[str, int], ...]
    owners: tuple[OwnerDifference, ...]


def worst_frames(
    run: RunRecord, core: str | None = None, stage: str | None = None, most: int = 3
) -> tuple[FrameProfile, tuple[FrameProfile, ...]]:
    """Return the median frame, and the `most` longest of those that took longer.

    Frames are compared by their cycles on one core or all together, in one stage or in all.
    """
    cores, stages = cores_of(run, core), stages_in(run, stage)
    frames = [(each.index, _owners(each, cores, stages)) for each in without_start_up(run).frames]
    ranked = sorted(frames, key=lambda each: (_cclk(each[1]), each[0]))
    median = ranked[(len(ranked) - 1) // 2]
    worst = [each for each in reversed(ranked) if _cclk(each[1]) > _cclk(median[1])][:most]
    return _compared(median, median), tuple(_compared(each, median) for each in worst)


_Owners = dict[tuple[str, str, str], list[OwnerCost]]
_Frame = tuple[int, _Owners]


def _owners(frame: FrameRecord, cores: Sequence[str], stages: Sequence[str]) -> _Owners:
    found: _Owners = {}
    for core in frame.cores:
        for each in core.owners if core.core in cores else ():
            if each.stage in stages:
                found.setdefault((each.stage, each.owner, each.symbol), []).append(each)
    return found


def _cclk(owners: _Owners) -> int:
    return sum(map(busy_cclk, owners.values()))


def _compared(frame: _Frame, median: _Frame) -> FrameProfile:
    index, here = frame
    there = median[1]
    stages: Counter[str] = Counter()
    owners = []
    for key in dict.fromkeys((*here, *there)):
        mine, usual = here.get(key, []), there.get(key, [])
        cclk = busy_cclk(mine) - busy_cclk(usual)
        stages[key[0]] += cclk
        calls = sum(each.calls for each in mine) - sum(each.calls for each in usual)
        if cclk or calls:
            owners.append(
                OwnerDifference(stage=key[0], owner=key[1], calls=calls, cclk=cclk, why=_why(mine, usual))
            )
    return FrameProfile(
        index=index,
        cclk=_cclk(here),
        difference_cclk=_cclk(here) - _cclk(there),
        stages=tuple(
            sorted(((name, cclk) for name, cclk in stages.items() if cclk), key=lambda each: -abs(each[1]))
        ),
        owners=tuple(sorted(owners, key=lambda each: -abs(each.cclk))),
    )


def _why(mine: Sequence[OwnerCost], usual: Sequence[OwnerCost]) -> str:
    """Return the kind of cycles that differs most: work, or the reason of a stall."""
    kinds: Counter[str] = Counter()
    for sign, costs in ((1, mine), (-1, usual)):
        for each in costs:
            kinds[WORK] += sign * each.issue_cclk
            for reason, cclk in each.stall_cclk.items():
                kinds[reason.value] += sign * cclk
    return max(kinds, key=lambda each: abs(kinds[each]), default=WORK)
