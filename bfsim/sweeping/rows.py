"""The points of a sweep as rows of its table."""

from __future__ import annotations

from dataclasses import asdict
from fractions import Fraction
from pathlib import PurePath

from bfsim.errors import ConfigError
from bfsim.fields import parsed
from bfsim.report.check.settings import written
from bfsim.report.sweep.figures import FRAME_RATE, SEEN
from bfsim.report.sweep.table import Cell, Row
from bfsim.sweeping.planned import Planned
from bfsim.sweeping.running import Outcome
from bfsim.sweeping.sweep import Sweep

NAMES = ("recording", "firmware", "board", "ldf")
"""Options that are also in the identity of a run, under the same name."""
OF_IDENTITY = (*NAMES, "compiler", "feed", "cclk_hz", "sclk_hz", "width_px", "height_px")
NOT_SHOWN = {*OF_IDENTITY, "profile", "frames"}
"""Options that other columns show."""


def rows_of(sweep: Sweep) -> list[Row]:
    """Return a row for each point. What was seen in one point is 0 in other finished points without it."""
    rows = [_row(each, sweep.outcomes.get(each.key)) for each in sweep.planned]
    seen = {name: 0 for row in rows for name in row if name.startswith(SEEN)}
    return [
        {**row, **{name: row.get(name, 0) for name in seen}} if FRAME_RATE in row else row for row in rows
    ]


def _row(planned: Planned, outcome: Outcome | None) -> Row:
    """Return the options of a point, and its outcome: figures, or why there are none."""
    point, identity = planned.point, planned.identity
    row: dict[str, Cell] = {"point": point.name}
    if identity:
        known = asdict(identity)
        row |= {name: known[name] for name in OF_IDENTITY}
        row["frames"] = planned.frames
    else:
        row |= {name: PurePath(str(point.options[name])).name for name in NAMES if name in point.options}
    row |= {path: _cell(path, value) for path, value in point.options.items() if path not in NOT_SHOWN}
    if outcome and outcome.figures:
        row |= outcome.figures
    row["warnings"] = "; ".join(outcome.warnings) if outcome else None
    row["error"] = planned.error or (outcome.error if outcome else None) or None
    row["seconds"] = round(outcome.seconds, 3) if outcome else None
    return row


def _cell(path: str, value: object) -> Cell:
    """Return an option, as a number if it is one."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return value
    text = written(value)
    if path.startswith("set."):
        try:
            return float(parsed(text, Fraction))
        except ConfigError:
            pass
    return text
