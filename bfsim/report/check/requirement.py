"""The sentences for limits: `"Look for lines".max <= 80 ms`.

    NAME [.min | .median | .max | .total]  <= | >= | ==  NUMBER [UNIT]

NAME is a dotted key as in TOML. Without a statistic the sentence is about every frame. `==` may be followed by a number
for each frame, with repeated ones as `0*5`. Only what firmware publishes may be negative.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby

from bfsim.report.check.figures import COUNTS, Figure, Name, Unit, statistic, unit_of

UNITS: dict[Unit, dict[str, Fraction | None]] = {
    Unit.HZ: {"Hz": Fraction(1)},
    Unit.CCLK: {
        "cycles": None,  # the others are times, and become cycles by the board's clock
        "s": Fraction(1),
        "ms": Fraction(1, 1000),
        "us": Fraction(1, 1_000_000),
    },
    Unit.BYTES: {"B": Fraction(1), "KB": Fraction(1024), "MB": Fraction(1024**2), "%": None},
    Unit.COUNT: {"": Fraction(1)},
}
"""The units of each kind of figure, as multiples of the kind's own unit."""

MS_DIGITS = 6
"""The digits that tell all cycles of a clock up to 1 GHz apart in a limit in ms."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """What a figure must be. `statistic` is empty for every frame; several `numbers` are one for each frame."""

    name: Name
    statistic: str
    comparison: str
    numbers: tuple[Fraction, ...]
    unit: str
    text: str

    @property
    def dotted(self) -> str:
        """The name of its figure, and the statistic, as written."""
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
        """Return the number of the figure that is compared; without a statistic, that of the worst frame."""
        name = self.statistic or ("min" if self.comparison == ">=" else "max")
        return statistic(figure, name)


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
    """Return the sentence that requires of each frame what it has now."""
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
