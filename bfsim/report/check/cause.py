"""Why a run breaks its limits: how it differs from the measured run or, if there is none, what takes most."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from bfsim.report.check.kept import kept_side, whole_side
from bfsim.report.check.verdicts import Outcome
from bfsim.report.diff.cells import cells, labelled
from bfsim.report.diff.compare import difference_between
from bfsim.report.diff.difference import Difference
from bfsim.report.diff.line_causes import line_text
from bfsim.report.diff.rows import shown
from bfsim.report.diff.scope import frames_compared, scope, seen_lines
from bfsim.report.diff.sentences import why
from bfsim.report.diff.side import Side
from bfsim.report.wording.units import milliseconds_of

CAUSES = 8
"""The number of causes that a failure shows."""
DEAREST = 3
"""The number of kernels of a stage, and of lines of each, that are shown if there is nothing to compare with."""
FRAMES_NAMED = 5
"""The number of frames with other results that are named."""


def difference_of_outcome(outcome: Outcome) -> Difference | None:
    """Return the difference from the run that the limits come from; None if none was measured."""
    if not outcome.case.has_costs:
        return None
    return difference_between(kept_side(outcome.case), whole_side(outcome.result))


def explanation(outcome: Outcome) -> Iterator[str]:
    """Yield why limits are broken, line by line: stages, kernels, source lines, causes, results, what was seen."""
    difference = difference_of_outcome(outcome)
    if difference is None:
        yield from dearest(whole_side(outcome.result), stages_of(outcome))
        return
    yield from (*why(difference), *scope(difference))
    rows = shown(difference, CAUSES)
    if rows:
        yield f"Cycles of all cores in {frames_compared(difference)}, before and now:"
    for depth, each in rows:
        before, after, more = cells(each)
        label = labelled(each).removesuffix(":")  # the source line of a `for` ends in one
        yield f"{'  ' * (depth + 1)}{label}: {f'{before} → {after}, ' if before else ''}{more}"
    yield from counts_that_differ(outcome)
    yield from seen_lines(difference)


def counts_that_differ(outcome: Outcome) -> Iterator[str]:
    """Yield the frames in which results differ; results that differ in the same frames share a line."""
    names: dict[tuple[int, ...], list[str]] = {}
    for verdict in outcome.broken:
        if verdict.frames:
            names.setdefault(verdict.frames, []).append(verdict.requirement.dotted)
    for frames, others in names.items():
        named = ", ".join(map(str, frames[:FRAMES_NAMED]))
        more = ", …" if len(frames) > FRAMES_NAMED else ""
        are_others = "are others" if len(others) > 1 else "is another"
        yield f"{', '.join(others)} {are_others} in frame{'s' if len(frames) > 1 else ''} {named}{more}"


def stages_of(outcome: Outcome) -> Collection[str]:
    """Return the stages whose limits are broken."""
    known = {owner.stage for owner in whole_side(outcome.result).owners}
    return known & {each.requirement.name[0] for each in outcome.broken}


def dearest(side: Side, stages: Collection[str]) -> Iterator[str]:
    """Yield the kernels and lines of these stages that take most; if no stage is named, of the two dearest ones."""
    by_stage: dict[str, int] = {}
    for owner, cclk in side.owners.items():
        by_stage[owner.stage] = by_stage.get(owner.stage, 0) + cclk
    largest = sorted(by_stage, key=lambda each: -by_stage[each])
    for stage in [each for each in largest if each in stages] or largest[:2]:
        yield f"{stage} takes {_ms(by_stage[stage], side)} a frame, all cores together:"
        owners = sorted(
            (each for each in side.owners if each.stage == stage), key=lambda each: -side.owners[each]
        )
        for owner in owners[:DEAREST]:
            source = side.sources.get(owner)
            yield f"  {owner.name}{f' ({source.place})' if source else ''}: {_ms(side.owners[owner], side)}"
            lines = sorted(source.lines if source else (), key=lambda each: -each.cclk)
            for line in lines[:DEAREST]:
                yield f"    {line.number}  {line.text.removesuffix(':')}: {_ms(line.cclk, side)}, {line_text(line)}"


def _ms(cclk: int, side: Side) -> str:
    return milliseconds_of(cclk / len(side.frames), side.cclk_hz)
