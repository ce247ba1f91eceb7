"""Compare the figures of a run with what is required: verdicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import chain, product
from pathlib import Path

from bfsim.errors import ConfigError
from bfsim.report.check.baseline import Case
from bfsim.report.check.baseline_file import requirements_of
from bfsim.report.check.figures import (
    COUNTS,
    OBJECTS,
    OF_THE_RUN,
    SEEN,
    Figure,
    Name,
    Unit,
    figures_of,
    is_of_a_stage,
)
from bfsim.report.check.requirement import Requirement, dotted, nearest_of
from bfsim.report.check.requirement_reading import parse_requirement
from bfsim.report.check.verdicts import Outcome, Verdict
from bfsim.report.results.result import Result
from bfsim.trace import RunRecord

FRAME_SHARE = 10
"""A stage may also grow by this part of a frame's tolerance: short stages vary with the traffic of others."""
HZ_RESOLUTION = 1e-6
"""The resolution in which a baseline has a frame rate, in Hz."""


def judge(case: Case, result: Result, path: Path) -> Outcome:
    """Compare a run of at least one frame with its limits in `path`. Raises ConfigError for a figure that it lacks."""
    required, limits = requirements_of(case, path)
    run, figures = result.run, figures_of(result)
    if result.seen:
        none = Figure(values=(0,) * len(run.frames), unit=Unit.COUNT)
        named = {each.name for each in (*required, *limits) if each.name[0] in SEEN}
        figures |= {name: none for name in named if name not in figures}
        new = [name for name in figures if name[0] == OBJECTS and name not in named]
        limits += [_nothing_of(name) for name in new if limits]
    tolerance = Fraction(str(case.tolerance_percent)) / 100
    results_tolerance = Fraction(str(case.results_tolerance_percent)) / 100
    frame = max(figures["frame",].values)
    verdicts = [
        _verdict(each, _figure(each, figures, case, path), run, Fraction(0), 0, is_persons=True)
        for each in required
    ]
    for each in limits:
        share = results_tolerance if each.name[0] in COUNTS else tolerance
        floor = frame / FRAME_SHARE
        figure = _figure(each, figures, case, path)
        verdicts.append(_verdict(each, figure, run, share, floor, is_persons=False))
    return Outcome(case=case, result=result, figures=figures, verdicts=tuple(verdicts))


def require_stages(case: Case, path: Path, stages: Sequence[str], cores: Sequence[str]) -> None:
    """Raise ConfigError if `path` has something on a stage or core that this firmware does not have.

    Nothing needs to run for that.
    """
    known = [*OF_THE_RUN, *((stage,) for stage in stages), *product(stages, cores)]
    for each in chain(*requirements_of(case, path)):
        if is_of_a_stage(each.name) and each.name not in known:
            raise _unknown(each, known, case, path)


def _nothing_of(name: Name) -> Requirement:
    """Return the limit of no objects of a kind, for kinds of which none were seen when the limits were measured."""
    return parse_requirement(f"{dotted((*name, 'max'))} == 0", "")


def _figure(requirement: Requirement, figures: Mapping[Name, Figure], case: Case, path: Path) -> Figure:
    figure = figures.get(requirement.name)
    if figure is None:
        raise _unknown(requirement, list(figures), case, path)
    return figure


def _unknown(requirement: Requirement, known: Sequence[Name], case: Case, path: Path) -> ConfigError:
    advice = "; --update --reason TEXT removes it" if requirement.text in case.limits else ""
    return ConfigError(
        f"{path}: run {case.name!r}: {dotted(requirement.name)} must be something that the run has; the nearest are "
        f"{nearest_of(requirement.name, known)}{advice}"
    )


def _verdict(
    requirement: Requirement,
    figure: Figure,
    run: RunRecord,
    share: Fraction,
    floor: float,
    *,
    is_persons: bool,
) -> Verdict:
    if len(requirement.numbers) > 1:
        return _frame_by_frame(requirement, figure, run, share, is_persons=is_persons)
    limit = requirement.limit(figure, run.identity.cclk_hz)
    base = max(limit, floor) if figure.unit is Unit.CCLK else limit
    slack = float(share * Fraction(abs(base)))
    measured = requirement.measured(figure)
    below, above = measured < limit - slack, measured > limit + slack
    broken = {"<=": above, ">=": below, "==": above or below}[requirement.comparison]
    if requirement.comparison == "==" and not requirement.statistic:
        broken = any(abs(each - limit) > slack for each in figure.values)
        measured = max(figure.values, key=lambda each: abs(each - limit))
    better = {"<=": below, ">=": measured > limit + slack + HZ_RESOLUTION, "==": False}
    return Verdict(
        requirement=requirement,
        is_persons=is_persons,
        unit=figure.unit,
        limit=limit,
        allowed={"<=": limit + slack, ">=": limit - slack, "==": limit}[requirement.comparison],
        measured=measured,
        broken=broken,
        better=better[requirement.comparison] and not is_persons,
    )


def _frame_by_frame(
    requirement: Requirement, figure: Figure, run: RunRecord, share: Fraction, *, is_persons: bool
) -> Verdict:
    pairs = list(zip(requirement.numbers, figure.values, strict=False))
    off = [index for index, (want, got) in enumerate(pairs) if abs(Fraction(got) - want) > share * abs(want)]
    are_as_many = len(requirement.numbers) == len(figure.values)
    limit, measured, frame = float(sum(requirement.numbers)), sum(figure.values), None
    if off and are_as_many:
        most = max(off, key=lambda index: abs(pairs[index][1] - pairs[index][0]))
        limit, measured, frame = float(pairs[most][0]), pairs[most][1], run.frames[most].index
    return Verdict(
        requirement=requirement,
        is_persons=is_persons,
        unit=figure.unit,
        limit=limit,
        allowed=limit,
        measured=measured,
        broken=bool(off) or not are_as_many,
        better=False,
        frames=tuple(run.frames[index].index for index in off),
        frame=frame,
    )
