"""Read the sentences of limits (`requirement`), with errors that point at the mistake."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NoReturn

from bfsim.errors import ConfigError, cut, shown
from bfsim.report.check.figures import (
    COUNTS,
    FRAME,
    FRAME_RATE,
    LATENCY,
    MEMORY,
    MISSED,
    OF_THE_RUN,
    RESULTS,
    STATISTICS,
    Name,
    Unit,
    unit_of,
)
from bfsim.report.check.requirement import UNITS, Requirement, dotted

_PART = re.compile(r'\s*(?:"([^"\n]*)"|([\w-]+))\s*')
_COMPARISON = re.compile(r"\s*(<=|>=|==)\s*")
_NUMBER = re.compile(r"(-?\d[\d_]*(?:\.\d+)?)\s*")
_NOT_WRITTEN_OUT = re.compile(r"[.,]|[eE][+-]?\d")
"""What may follow a number by mistake: an exponent, or a second point or comma."""
_COUNT = r"-?\d[\d_]*(?:\*[1-9]\d{0,6})?"
_COUNTS = re.compile(rf"{_COUNT}(?:\s+{_COUNT})*\s*")
_TIMES = re.compile(r"\*(\d+)")
LONGEST_NUMBER = 30
"""Digits; no figure of a run has more."""
_TOO_LONG = re.compile(rf".*[\d_]{{{LONGEST_NUMBER + 1}}}")
MOST_FRAMES = 1_000_000
"""The most frames with a number each, as these are kept in memory: eleven hours at 25 a second."""


def parse_requirement(text: str, where: str) -> Requirement:
    """Read a sentence. Raises ConfigError that says `where` it is, with a caret under the mistake."""
    sentence = _Sentence(text, where)
    parts, at = sentence.parts()
    stands_for = parts[-1][1] if len(parts) > _least(parts[0][1]) and parts[-1][1] in STATISTICS else ""
    name = tuple(part for _, part in (parts[:-1] if stands_for else parts))
    sentence.require_name(name, parts)
    comparison, begin = sentence.comparison(at)
    if _TOO_LONG.match(text, begin):
        sentence.fail(f"after {comparison} must come numbers of at most {LONGEST_NUMBER} digits", begin)
    is_published = name[0] == RESULTS
    wanted = f"after {comparison} must come a number{'' if is_published else ' that is not negative'}"
    counts = _COUNTS.fullmatch(text, begin) if unit_of(name) is Unit.COUNT else None
    if counts:
        numbers, unit = sentence.counts(counts, comparison), ""
        if len(numbers) > 1 and (comparison != "==" or stands_for):
            sentence.fail("a number for each frame must come after == and a name without statistic", begin)
    else:
        number, end = sentence.number(begin, comparison, wanted)
        numbers, unit = (number,), sentence.unit(end, name)
    if min(numbers) < 0 and not is_published:
        sentence.fail(wanted, begin)
    return Requirement(
        name=name, statistic=stands_for, comparison=comparison, numbers=numbers, unit=unit, text=text
    )


@dataclass(frozen=True, slots=True)
class _Sentence:
    """A sentence, read part by part from a position onwards."""

    text: str
    where: str

    def parts(self) -> tuple[list[tuple[int, str]], int]:
        """Return the parts of the name with their positions, and where the name ends."""
        parts, at = list[tuple[int, str]](), 0
        while True:
            found = _PART.match(self.text, at)
            if not found:
                self.fail('must begin with a name, such as frame_rate or "Edge".max', at)
            parts.append((at, found[2] if found[1] is None else found[1]))
            at = found.end()
            if not self.text.startswith(".", at):
                return parts, at
            at += 1

    def require_name(self, name: Name, parts: Sequence[tuple[int, str]]) -> None:
        """Fail if a name has too many or too few parts for what it begins with."""
        most = 2 if (name[:1]) not in {FRAME_RATE, MISSED, LATENCY, FRAME} else 1
        if len(name) > most:
            what = f"{', '.join(STATISTICS[:-1])} or {STATISTICS[-1]}"
            self.fail(f"{dotted(name[:most])} must be followed by {what}, or nothing", parts[most][0])
        if len(name) < _least(name[0]):
            self.fail(f"{name[0]} must be followed by a name, such as {name[0]}.L2", len(name[0]))

    def comparison(self, at: int) -> tuple[str, int]:
        """Return the comparison, and where it ends."""
        found = _COMPARISON.match(self.text, at)
        if not found:
            self.fail("after the name must come <=, >= or ==", at)
        return found[1], found.end()

    def counts(self, found: re.Match[str], comparison: str) -> tuple[Fraction, ...]:
        """Return a count, or one for each frame."""
        if sum(int(each) for each in _TIMES.findall(found[0])) > MOST_FRAMES:
            problem = f"after {comparison} must come counts of at most {MOST_FRAMES:,} frames"
            self.fail(problem, found.start())
        return _counted(found[0])

    def number(self, at: int, comparison: str, wanted: str) -> tuple[Fraction, int]:
        """Return a number, and where it ends."""
        found = _NUMBER.match(self.text, at)
        if not found:
            self.fail(wanted, at)
        if _NOT_WRITTEN_OUT.match(self.text, found.end(1)):
            self.fail(f"after {comparison} must come a number written out, such as 12_000 or 0.25", at)
        return Fraction(found[1].replace("_", "")), found.end()

    def unit(self, at: int, name: Name) -> str:
        """Return the unit after a number."""
        kind, named = unit_of(name), self.text[at:].strip()
        if named not in UNITS[kind]:
            known = " or ".join(each or "none" for each in UNITS[kind])
            is_stage = kind is Unit.CCLK and name not in {LATENCY, FRAME}
            what = f"the unit of {'the stage ' if is_stage else ''}{'.'.join(name)}"
            self.fail(f"{what} must be {known}, not {shown(named)}{_meant(name) if is_stage else ''}", at)
        return named

    def fail(self, problem: str, at: int) -> NoReturn:
        """Raise ConfigError with a caret at a position, unless the sentence is too long to be shown."""
        if len(self.text) > len(cut(self.text)):
            raise ConfigError(f"{self.where}: {problem} ({cut(self.text)})")
        raise ConfigError(f"{self.where}: {problem}\n    {cut(self.text)}\n    {' ' * at}^")


def _least(first: str) -> int:
    """Return the least number of parts of a name that begins so; an object may be called max."""
    return 2 if first in {MEMORY, *COUNTS} else 1


def _meant(name: Name) -> str:
    """Return a hint if a supposed stage is nearly the name of something else."""
    near = difflib.get_close_matches(dotted(name), [dotted(each) for each in OF_THE_RUN])
    return f"; did you mean {near[0]}?" if near else ""


def _counted(text: str) -> tuple[Fraction, ...]:
    numbers = list[Fraction]()
    for each in text.split():
        value, _, times = each.partition("*")
        numbers += [Fraction(value.replace("_", ""))] * int(times or 1)
    return tuple(numbers)
