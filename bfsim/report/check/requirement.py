"""The sentences that limits are written in: `"Look for lines".max <= 80 ms`.

    NAME [.min | .median | .max | .total]  <= | >= | ==  NUMBER [UNIT]

NAME is a dotted key as in TOML. Without a statistic the sentence is about every frame. After `==` there may be a number for
each frame, with repeated ones as `0*5`. Only what firmware publishes may be negative.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby
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
    Figure,
    Name,
    Unit,
    statistic,
    unit_of,
)

UNITS: dict[Unit, dict[str, Fraction | None]] = {
    Unit.HZ: {"Hz": Fraction(1)},
    Unit.CCLK: {
        "cycles": None,  # the others are seconds, and become cycles by the board's clock
        "s": Fraction(1),
        "ms": Fraction(1, 1000),
        "us": Fraction(1, 1_000_000),
    },
    Unit.BYTES: {"B": Fraction(1), "KB": Fraction(1024), "MB": Fraction(1024**2), "%": None},
    Unit.COUNT: {"": Fraction(1)},
}
"""The units of each kind of figure, and how much of the kind's own unit they are."""

MS_DIGITS = 6
"""Digits by which a limit in ms says each cycle of a clock up to 1 GHz."""

_PART = re.compile(r'\s*(?:"([^"\n]*)"|([\w-]+))\s*')
_COMPARISON = re.compile(r"\s*(<=|>=|==)\s*")
_NUMBER = re.compile(r"(-?\d[\d_]*(?:\.\d+)?)\s*")
_NOT_WRITTEN_OUT = re.compile(r"[.,]|[eE][+-]?\d")
"""Behind a number: an exponent, or what is no unit."""
_COUNT = r"-?\d[\d_]*(?:\*[1-9]\d{0,6})?"
_COUNTS = re.compile(rf"{_COUNT}(?:\s+{_COUNT})*\s*")
_TIMES = re.compile(r"\*(\d+)")
LONGEST_NUMBER = 30
"""Digits; more is no figure of a run."""
_TOO_LONG = re.compile(rf".*[\d_]{{{LONGEST_NUMBER + 1}}}")
MOST_FRAMES = 1_000_000
"""A number for each frame is kept in memory; so many are eleven hours at 25 a second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """What a figure must be. `statistic` is empty for every frame; more than one of `numbers` are one for each frame."""

    name: Name
    statistic: str
    comparison: str
    numbers: tuple[Fraction, ...]
    unit: str
    text: str

    @property
    def dotted(self) -> str:
        """What it is about, as it is written."""
        return dotted((*self.name, self.statistic) if self.statistic else self.name)

    def limit(self, figure: Figure, cclk_hz: float) -> float:
        """Return the number in the unit of the figure: whole cycles or bytes, Hz, or a count."""
        number = self.numbers[0]
        if self.unit == "%":
            return float(number * Fraction(figure.whole) / 100)
        scale = UNITS[figure.unit][self.unit]
        if figure.unit is Unit.CCLK:
            return round(number * (1 if scale is None else scale * Fraction(cclk_hz)))
        assert scale is not None
        return float(number * scale)

    def measured(self, figure: Figure) -> float:
        """Return the number of the figure that is compared: without a statistic that of the worst frame."""
        name = self.statistic or ("min" if self.comparison == ">=" else "max")
        return statistic(figure, name)


def parse_requirement(text: str, where: str) -> Requirement:
    """Read a sentence. Raises ConfigError that names `where` it stands, with a caret under what is wrong."""
    parts, at = _parts(text, where)
    stands_for = parts[-1][1] if len(parts) > 1 and parts[-1][1] in STATISTICS else ""
    name = tuple(part for _, part in (parts[:-1] if stands_for else parts))
    _require_name(name, parts, text, where)
    found = _COMPARISON.match(text, at)
    if not found:
        _fail("after the name must come <=, >= or ==", text, at, where)
    comparison, at = found[1], found.end()
    unit, is_published = unit_of(name), name[0] == RESULTS
    wanted = f"after {comparison} must come a number{'' if is_published else ' that is not negative'}"
    begin = at
    counts = _COUNTS.fullmatch(text, at)
    if _TOO_LONG.match(text, at):
        _fail(f"after {comparison} must come numbers of at most {LONGEST_NUMBER} digits", text, at, where)
    if counts and unit is Unit.COUNT:
        if sum(int(each) for each in _TIMES.findall(counts[0])) > MOST_FRAMES:
            _fail(f"after {comparison} must come counts of at most {MOST_FRAMES:,} frames", text, at, where)
        numbers, named = _counted(counts[0]), ""
        if len(numbers) > 1 and (comparison != "==" or stands_for):
            _fail("a number for each frame must come after == and a name without statistic", text, at, where)
    else:
        number = _NUMBER.match(text, at)
        if not number:
            _fail(wanted, text, at, where)
        numbers, at = (Fraction(number[1].replace("_", "")),), number.end()
        if _NOT_WRITTEN_OUT.match(text, number.end(1)):
            _fail(
                f"after {comparison} must come a number written out, such as 12_000 or 0.25",
                text,
                begin,
                where,
            )
        named = text[at:].strip()
        if named not in UNITS[unit]:
            known = " or ".join(each or "none" for each in UNITS[unit])
            is_stage = unit is Unit.CCLK and name not in {LATENCY, FRAME}
            what = f"the unit of {'the stage ' if is_stage else ''}{'.'.join(name)}"
            _fail(
                f"{what} must be {known}, not {shown(named)}{_meant(name) if is_stage else ''}",
                text,
                at,
                where,
            )
    if min(numbers) < 0 and not is_published:
        _fail(wanted, text, begin, where)
    return Requirement(
        name=name, statistic=stands_for, comparison=comparison, numbers=numbers, unit=named, text=text
    )


def limit_text(name: Name, value: float, cclk_hz: float, stands_for: str = "") -> str:
    """Return the sentence that allows `value` and nothing worse."""
    key = dotted((*name, stands_for) if stands_for else name)
    match unit_of(name):
        case Unit.HZ:
            return f"{key} >= {int(value * 10**MS_DIGITS) / 10**MS_DIGITS:.{MS_DIGITS}f} Hz"
        case Unit.CCLK:
            return f"{key} <= {value * 1000 / cclk_hz:.{MS_DIGITS}f} ms"
        case Unit.BYTES:
            return f"{key} <= {value:.0f} B"
        case Unit.COUNT:
            return f"{key} {'==' if name[0] in COUNTS else '<='} {value:.0f}"


def counts_text(name: Name, values: Sequence[float]) -> str:
    """Return the sentence that each frame must have what it has."""
    runs = ((value, len(list(same))) for value, same in groupby(map(int, values)))
    numbers = (f"{value}*{times}" if times > 1 else str(value) for value, times in runs)
    return f"{dotted(name)} == {' '.join(numbers)}"


def dotted(name: Name) -> str:
    """Return a name as it is written."""
    return ".".join(each if re.fullmatch(r"[\w-]+", each) else f'"{each}"' for each in name)


def nearest_of(name: Name, known: Sequence[Name]) -> str:
    """Return a few of the known names that are most like `name`."""
    texts = {dotted(each): None for each in known}
    return ", ".join(difflib.get_close_matches(dotted(name), texts, n=4, cutoff=0))


def _parts(text: str, where: str) -> tuple[list[tuple[int, str]], int]:
    """Return the parts of the name with their places, and where it ends."""
    parts, at = list[tuple[int, str]](), 0
    while True:
        found = _PART.match(text, at)
        if not found:
            _fail('must begin with a name, such as frame_rate or "Edge".max', text, at, where)
        parts.append((at, found[2] if found[1] is None else found[1]))
        at = found.end()
        if not text.startswith(".", at):
            return parts, at
        at += 1


def _require_name(name: Name, parts: Sequence[tuple[int, str]], text: str, where: str) -> None:
    most = 2 if (name[:1]) not in {FRAME_RATE, MISSED, LATENCY, FRAME} else 1
    least = 2 if name[0] in {MEMORY, *COUNTS} else 1
    if len(name) > most:
        what = f"{', '.join(STATISTICS[:-1])} or {STATISTICS[-1]}"
        _fail(f"{dotted(name[:most])} must be followed by {what}, or nothing", text, parts[most][0], where)
    if len(name) < least:
        _fail(f"{name[0]} must be followed by a name, such as {name[0]}.L2", text, len(name[0]), where)


def _meant(name: Name) -> str:
    """Return a hint where what is taken for a stage is nearly the name of something else."""
    near = difflib.get_close_matches(dotted(name), [dotted(each) for each in OF_THE_RUN])
    return f"; what is no stage is called {near[0]}" if near else ""


def _counted(text: str) -> tuple[Fraction, ...]:
    numbers = list[Fraction]()
    for each in text.split():
        value, _, times = each.partition("*")
        numbers += [Fraction(value.replace("_", ""))] * int(times or 1)
    return tuple(numbers)


def _fail(problem: str, text: str, at: int, where: str) -> NoReturn:
    if len(text) > len(cut(text)):
        raise ConfigError(f"{where}: {problem} ({cut(text)})")
    raise ConfigError(f"{where}: {problem}\n    {cut(text)}\n    {' ' * at}^")
