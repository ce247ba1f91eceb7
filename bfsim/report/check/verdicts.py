"""The outcome of a check: a verdict on each sentence, and all of them together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bfsim.report.check.baseline import Case
from bfsim.report.check.figures import Figure, Name, Unit
from bfsim.report.check.requirement import Requirement
from bfsim.report.results.result import Result
from bfsim.trace import RunRecord


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """A sentence and what was measured, in the figure's unit.

    `limit` is what was written, `allowed` includes its tolerance; after `==`, which can be broken both ways, `allowed`
    is the limit. `frames` are those whose results differ, by index; if there are any, limit and measured are those of
    `frame`, which is furthest off. They are totals if no frame differs, or if there are more or fewer frames than
    limits.
    """

    requirement: Requirement
    is_persons: bool
    unit: Unit
    limit: float
    allowed: float
    measured: float
    broken: bool
    better: bool
    frames: tuple[int, ...] = ()
    frame: int | None = None

    @property
    def label(self) -> str:
        """What was measured, and in which frame."""
        where = "" if self.frame is None else f" in frame {self.frame}"
        return f"{self.requirement.dotted}{where}"

    @property
    def by_percent(self) -> float:
        """By how much the measured value exceeds the limit, in percent of its size."""
        return 100 * (self.measured - self.limit) / abs(self.limit) if self.limit else 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """The outcome for one run of the baseline file."""

    case: Case
    result: Result
    figures: Mapping[Name, Figure]
    verdicts: tuple[Verdict, ...]

    @property
    def run(self) -> RunRecord:
        """The records of the run."""
        return self.result.run

    @property
    def passed(self) -> bool:
        """Whether no limit is broken."""
        return not any(each.broken for each in self.verdicts)

    @property
    def broken(self) -> tuple[Verdict, ...]:
        """The broken limits, those of the whole run first."""
        return tuple(each for each in self.verdicts if each.broken)

    @property
    def better(self) -> tuple[Verdict, ...]:
        """The limits that were beaten by more than the tolerance."""
        return tuple(each for each in self.verdicts if each.better)


def worst_of_each(verdicts: Sequence[Verdict]) -> Iterator[Verdict]:
    """For each figure, yield the limit that is furthest off: the others say the same."""
    names = dict.fromkeys(each.requirement.name for each in verdicts)
    for name in names:
        same = [each for each in verdicts if each.requirement.name == name]
        yield max(same, key=lambda each: (each.is_persons, abs(each.by_percent)))


def left_out(verdicts: Sequence[Verdict]) -> int:
    """Return how many limits `worst_of_each` leaves out."""
    return len(verdicts) - len({each.requirement.name for each in verdicts})
