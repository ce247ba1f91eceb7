"""`--history`: a line of JSON for each run that was checked, and the trend of their frame times."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from bfsim.errors import ConfigError
from bfsim.files.content import read_bounded
from bfsim.files.save import alone_in, write_bytes
from bfsim.report.check.as_json import figures_json
from bfsim.report.check.verdicts import Outcome
from bfsim.report.tables.table import new_table

TREND = "frame.median ms"
"""The figure that the trend shows."""
BARS = "▁▂▃▄▅▆▇█"
DRAWN = 30
"""The number of a run's last lines that the trend shows."""


def append_history(path: Path, outcomes: Sequence[Outcome], commit: str) -> None:
    """Append a line for each run, all or none, even if two processes do so. Raises ConfigError if that fails."""
    with alone_in(path.parent):
        before = read_bounded(path) if path.exists() else b""
        end = b"\n" if before and not before.endswith(b"\n") else b""  # an editor may have left it out
        write_bytes(path, [before, end, _lines(outcomes, commit).encode()])


def _lines(outcomes: Sequence[Outcome], commit: str) -> str:
    return "".join(
        json.dumps(
            {
                "commit": commit,
                "run": outcome.case.name,
                "passed": outcome.passed,
                "configuration": outcome.case.configuration.model_dump(exclude_defaults=True),
                "firmware_digest": outcome.run.identity.firmware_digest,
                "bfsim_version": outcome.run.identity.bfsim_version,
                "figures": figures_json(outcome),
            },
            ensure_ascii=False,
        )
        + "\n"
        for outcome in outcomes
    )


def read_history(path: Path) -> list[dict[str, Any]]:
    """Return the lines of a history, none if it does not exist yet. Raises ConfigError for an invalid line."""
    if not path.exists():
        return []
    try:
        lines = read_bounded(path).decode("utf-8-sig").split("\n")
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path} must be a readable history of `bfsim check`: {error}") from error
    except OSError as error:
        raise ConfigError(f"{path} must be a readable history of `bfsim check`: {error.strerror}") from error
    return [_entry(line, f"{path}:{number}") for number, line in enumerate(lines, 1) if line.strip()]


def trend_table(history: Sequence[dict[str, Any]], names: Sequence[str]) -> Table:
    """Return the frame times of each run's last lines, as bars from the least to the most, with these two."""
    table = new_table("Work of a frame, median, ms", "Run", "First", "Least", "Most", "Now", "Trend")
    table.columns[-1].justify = "left"
    for name in names:
        times = [each["figures"][TREND] for each in history if each["run"] == name][-DRAWN:]
        numbers = (f"{each:.2f}" for each in (times[0], min(times), max(times), times[-1]))
        table.add_row(name, *numbers, _bars(times))
    return table


def _entry(line: str, where: str) -> dict[str, Any]:
    try:
        entry: dict[str, Any] = json.loads(line)
        is_one = isinstance(entry["figures"][TREND], int | float) and math.isfinite(entry["figures"][TREND])
        is_one = is_one and isinstance(entry["run"], str)
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
        is_one = False
    if not is_one:
        raise ConfigError(f"{where} must be a line that `bfsim check --history` wrote, but is none")
    return entry


def _bars(values: Sequence[float]) -> str:
    least, span = min(values), max(values) - min(values)
    return "".join(BARS[round((each - least) / span * (len(BARS) - 1)) if span else 0] for each in values)
