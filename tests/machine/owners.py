"""Owners of cycles in tests: what all records of one run must add up to."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from bfsim.trace import BoardRecord, OwnerCost, StageCost, StallReason

Sums = Counter[tuple[str, str, str, object]]
"""Cycles by core, stage, symbol, and what: "issue", or the reason of a stall."""


def assert_owned(outcome: BoardRecord) -> None:
    """The owners of each stage fill it, and kernels, their lines, what they accessed and the paths to them add up to theirs."""
    for core in (core for frame in outcome.frames for core in frame.cores):
        for stage in core.stages:
            assert_filled(stage, [each for each in core.owners if each.stage == stage.stage])
        assert {each.stage for each in core.owners} <= {each.stage for each in core.stages}
    owned, calls = _owned(outcome)
    lines, kernels, paths = Sums(), Sums(), Sums()
    for kernel in outcome.kernels:
        place = kernel.core, kernel.stage, kernel.symbol
        _add(kernels, place, kernel.issue_cclk, kernel.stall_cclk)
        for line in kernel.lines:
            _add(lines, place, line.issue_cclk, line.stall_cclk)
            assert sum(cclk for _, cclk in line.operations.values()) == line.issue_cclk
            assert all(count > 0 for count, _ in line.operations.values())
    for path in outcome.paths:
        _add(paths, (path.core, path.stage, path.path[-1]), path.issue_cclk, path.stall_cclk)
    assert kernels == owned
    assert lines == owned
    assert paths == owned
    assert +Counter({(each.core, each.stage, each.symbol): each.calls for each in outcome.kernels}) == calls
    assert _calls_of_paths(outcome) == calls
    assert _at_accesses(outcome) == {key: cclk for key, cclk in owned.items() if key[3] not in OF_OPERATIONS}


OF_OPERATIONS = ("issue", StallReason.INTERLOCK)
"""What no access is to blame for."""


def assert_filled(stage: StageCost, owners: Iterable[OwnerCost]) -> None:
    """Issue, each reason of a stall and idle of the owners add up to those of the stage."""
    owners = list(owners)
    stalls: Counter[StallReason] = Counter()
    for each in owners:
        assert min(each.issue_cclk, each.idle_cclk, each.calls) >= 0
        assert all(cclk > 0 for cclk in each.stall_cclk.values())
        stalls.update(each.stall_cclk)
    assert sum(each.issue_cclk for each in owners) == stage.issue_cclk, stage.stage
    assert sum(each.idle_cclk for each in owners) == stage.idle_cclk, stage.stage
    assert stalls == stage.stall_cclk, stage.stage


def _owned(outcome: BoardRecord) -> tuple[Sums, Counter[tuple[str, str, str]]]:
    """Return the cycles and the calls of kernels in all frames."""
    sums, calls = Sums(), Counter[tuple[str, str, str]]()
    for core in (core for frame in outcome.frames for core in frame.cores):
        for each in core.owners:
            if each.symbol:
                _add(sums, (core.core, each.stage, each.symbol), each.issue_cclk, each.stall_cclk)
                calls[core.core, each.stage, each.symbol] += each.calls
    return sums, +calls


def _calls_of_paths(outcome: BoardRecord) -> Counter[tuple[str, str, str]]:
    calls = Counter[tuple[str, str, str]]()
    for each in outcome.paths:
        calls[each.core, each.stage, each.path[-1]] += each.calls
    return +calls


def _at_accesses(outcome: BoardRecord) -> dict[tuple[str, str, str, object], int]:
    sums = Sums()
    for each in outcome.accesses:
        _add(sums, (each.core, each.stage, each.symbol), 0, each.stall_cclk)
    return dict(sums)


def _add(sums: Sums, place: tuple[str, str, str], issue_cclk: int, stalls: Mapping[StallReason, int]) -> None:
    for what, cclk in (("issue", issue_cclk), *stalls.items()):
        if cclk:
            sums[*place, what] += cclk
