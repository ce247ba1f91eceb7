"""Where the cycles go: stage, owner and source line. Each level adds up to the one above, and the first to the frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from bfsim.report.budget.rows import budget_rows, stage_names
from bfsim.report.budget.start_up import without_start_up
from bfsim.report.profile.cost import Cost, sum_of
from bfsim.report.profile.library import in_callers
from bfsim.report.profile.lines import LineProfile, lines_of, place_of
from bfsim.trace import CoreFrame, KernelRecord, Later, OwnerCost, RunRecord
from bfsim.trace.owner_costs import sum_of_owners


@dataclass(slots=True, kw_only=True)
class OwnerProfile:
    """One owner in a stage: a kernel without its callees or, without a `symbol`, something else. `place` is file:line.

    A kernel includes the library routines that it calls, in the lines of their calls.
    """

    owner: str
    symbol: str
    place: str = ""
    calls: int = 0
    cost: Cost = field(default_factory=Cost)
    lines: Sequence[LineProfile] = ()


Owners = dict[tuple[str, str], OwnerProfile]
"""The owners of a stage, by name and symbol."""


@dataclass(slots=True, kw_only=True)
class StageProfile:
    """The owners of one stage, the dearest first."""

    stage: str
    cost: Cost
    owners: tuple[OwnerProfile, ...]


@dataclass(slots=True, kw_only=True)
class Profile:
    """A breakdown of the frames of some cores. Shares are parts of `whole`: these frames, on these cores together.

    `cost` is what the `stages` add up to: the whole, or one row of the budget with its parts.
    """

    cores: tuple[str, ...]
    frames: int
    whole: Cost
    stages: tuple[StageProfile, ...]

    @property
    def cost(self) -> Cost:
        """The sum of the `stages`."""
        return sum_of(each.cost for each in self.stages)

    def share(self, cclk: int) -> float:
        """Return the share of some cycles in the whole, 0..1."""
        return cclk / self.whole.elapsed_cclk if self.whole.elapsed_cclk else 0.0


def stages_in(run: RunRecord, stage: str | None) -> tuple[str, ...]:
    """Return the stages of a row of the budget, itself and its parts; without a name, all of them."""
    within = {each.stage: each.within for each in budget_rows(run)}
    return tuple(each for each in stage_names(run) if stage in (None, each, within.get(each)))


def cores_of(run: RunRecord, core: str | None = None) -> tuple[str, ...]:
    """Return the cores of a run, or the one that was asked for."""
    return tuple(each.core for each in run.frames[0].cores) if core is None else (core,)


def core_frames(run: RunRecord, cores: Sequence[str]) -> Iterator[CoreFrame]:
    """Yield the frames of a run on these cores, without the start-up."""
    for frame in without_start_up(run).frames:
        yield from (each for each in frame.cores if each.core in cores)


def profile_of(run: RunRecord, core: str | None = None, stage: str | None = None) -> Profile:
    """Break down a run of at least one frame, for one core or all together, and for one stage or all."""
    cores, stages = cores_of(run, core), stages_in(run, stage)
    owners: dict[str, Owners] = {}
    costs: dict[str, Cost] = {}
    whole = Cost()
    for frame in core_frames(run, cores):
        for each in frame.stages:
            whole.add(each.issue_cclk, each.stall_cclk, each.idle_cclk)
            costs.setdefault(each.stage, Cost()).add(each.issue_cclk, each.stall_cclk, each.idle_cclk)
    for owner in sum_of_owners(frame.owners for frame in core_frames(run, cores)):
        if owner.stage in stages:
            _add_owner(owners.setdefault(owner.stage, {}), owner)
    _add_kernels(owners, [each for each in run.kernels if each.core in cores and each.symbol])
    return Profile(
        cores=cores,
        frames=len(run.frames),
        whole=whole,
        stages=tuple(
            StageProfile(stage=each, cost=costs[each], owners=_dearest(owners.get(each, {}).values()))
            for each in stages
            if each in costs and costs[each].elapsed_cclk
        ),
    )


def _add_kernels(owners: Mapping[str, Owners], kernels: Sequence[KernelRecord]) -> None:
    """Add lines to the owners that are kernels, and the cost of library routines to their callers."""
    found: dict[tuple[str, str, str], list[KernelRecord]] = {}
    for alone, told in zip(kernels, in_callers(kernels), strict=True):
        if mine := owners.get(told.stage, {}).get((told.kernel, told.symbol)):
            found.setdefault((told.stage, told.kernel, told.symbol), []).append(told)
            mine.cost.add(told.issue_cclk, told.stall_cclk)
            mine.cost.take(alone.issue_cclk, alone.stall_cclk)
    for (stage, kernel, symbol), records in found.items():
        mine = owners[stage][kernel, symbol]
        mine.place = place_of(records[0])
        mine.lines = Later(partial(_lines_that_ran, records))
        if mine.calls and not mine.cost.elapsed_cclk:
            del owners[stage][kernel, symbol]  # a routine, whose cost is now in its callers


def _lines_that_ran(records: Sequence[KernelRecord]) -> list[LineProfile]:
    return [each for each in lines_of(records) if each.executions or each.cost.elapsed_cclk]


def _dearest(owners: Iterable[OwnerProfile]) -> tuple[OwnerProfile, ...]:
    return tuple(sorted(owners, key=lambda each: -each.cost.elapsed_cclk))


def _add_owner(owners: Owners, cost: OwnerCost) -> None:
    key = cost.owner, cost.symbol
    found = owners.setdefault(key, OwnerProfile(owner=cost.owner, symbol=cost.symbol))
    found.calls += cost.calls
    found.cost.add(cost.issue_cclk, cost.stall_cclk, cost.idle_cclk)
