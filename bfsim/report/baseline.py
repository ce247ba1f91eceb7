"""What `bfsim check` holds a run against: a small TOML file in the user's repository.

The file keeps the frame rate and, per core and row of the budget, the median and the maximum cycles. A run may be
worse by no more than the tolerance, which is zero unless the file says otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping, MutableMapping
from pathlib import Path
from typing import Annotated, Any

import tomlkit
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from tomlkit import TOMLDocument
from tomlkit.exceptions import TOMLKitError

from bfsim.errors import ConfigError, cut, shown
from bfsim.report.budget import Budget
from bfsim.report.save import write_text
from bfsim.trace import Identity, RunRecord

_NEW_FILE = """\
# What `bfsim check` holds every run against. `--update` writes the numbers anew and leaves comments and
# tolerances alone. Nothing may be worse by more than the tolerance; [run] and any row may have their own.
tolerance_percent = 0
"""

Cycles = Annotated[int, Field(ge=0)]
Percent = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class _Table(BaseModel):
    """A TOML table: no unknown keys, no conversions."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class MeasuredOn(_Table):
    """What the limits were measured on. Limits of one such set say nothing about a run of another."""

    recording: str
    recording_digest: str
    frames: Cycles
    firmware: str
    board: str
    ldf: str
    compiler: str
    feed: str
    fidelity: str = "fast"  # all there was when the first baselines were written
    script_digest: str = ""


class MeasuredBy(_Table):
    """The tools that measured the limits. Where they differ, numbers may move without a change in the firmware."""

    bfsim_version: str
    llvm_version: str


class RunLimits(_Table):
    """Limits of the run as a whole."""

    frame_rate_hz: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    missed_frames: Cycles
    tolerance_percent: Percent | None = None


class RowLimits(_Table):
    """Limits of one row on one core."""

    median_cclk: Cycles
    max_cclk: Cycles
    tolerance_percent: Percent | None = None


class Baseline(_Table):
    """The whole file; `core` is core name → row name → limits."""

    tolerance_percent: Percent = 0
    measured_on: MeasuredOn
    measured_by: MeasuredBy
    run: RunLimits
    core: dict[str, dict[str, RowLimits]]


def read_baseline(path: Path) -> Baseline:
    """Read a baseline file. Raises ConfigError that names the file, the key and what must be there."""
    if not path.exists():
        raise ConfigError(f"{path} must be a baseline file, but there is none: make it with --update")
    return _validated(_parsed(path), path)


def write_baseline(path: Path, run: RunRecord, budget: Budget) -> None:
    """Write the numbers of a run to `path`. Comments and tolerances in a file already there are kept.

    Rows that the run does not have are removed. Raises ConfigError, and leaves the file alone, if it is no baseline.
    """
    document = _parsed(path) if path.exists() else tomlkit.parse(_NEW_FILE)
    measured = _measured(run, budget)
    _merge(document, measured)
    _validated(document, path)
    _prune(document["core"], measured["core"])
    write_text(path, tomlkit.dumps(document))


def measured_on(identity: Identity, frames: int) -> MeasuredOn:
    """Return what a run of so many frames, missed ones included, is measured on."""
    given = {name: getattr(identity, name) for name in MeasuredOn.model_fields if name != "frames"}
    return MeasuredOn(frames=frames, **given)


def measured_by(identity: Identity) -> MeasuredBy:
    """Return the tools that measured a run."""
    return MeasuredBy(bfsim_version=identity.bfsim_version, llvm_version=identity.llvm_version)


def _parsed(path: Path) -> TOMLDocument:
    try:
        return tomlkit.parse(path.read_text(encoding="utf-8"))
    except (TOMLKitError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path} must be TOML: {cut(str(error))}") from error
    except OSError as error:
        raise ConfigError(f"{path} must be a readable file: {error.strerror}") from error


def _validated(document: TOMLDocument, path: Path) -> Baseline:
    try:
        return Baseline.model_validate(document.unwrap())
    except ValidationError as error:
        first = error.errors()[0]
        key = cut(".".join(str(part) for part in first["loc"]))
        match first["type"]:
            case "missing":
                raise ConfigError(f"{path}: the key {key} must be there; --update writes it") from error
            case "extra_forbidden":
                raise ConfigError(f"{path}: {key} must not be there: a baseline has no such key") from error
        must_be = first["msg"].replace("Input should", "must").removesuffix(" instance")
        raise ConfigError(f"{path}: {key} {must_be}, not {shown(first['input'])}") from error


def _measured(run: RunRecord, budget: Budget) -> dict[str, Any]:
    """Return the numbers of a run in the layout of the file."""
    return {
        "measured_on": measured_on(run.identity, len(run.frames) + len(run.missed)).model_dump(),
        "measured_by": measured_by(run.identity).model_dump(),
        "run": {"frame_rate_hz": budget.frame_rate_hz, "missed_frames": len(run.missed)},
        "core": {
            core.core: {
                row.name: {"median_cclk": row.elapsed_cclk.median, "max_cclk": row.elapsed_cclk.maximum}
                for row in core.all_rows
            }
            for core in budget.cores
        },
    }


def _merge(table: MutableMapping[str, Any], values: Mapping[str, Any]) -> None:
    """Set `values` in a TOML table, key by key, so that everything else in it stays."""
    for key, value in values.items():
        if isinstance(value, Mapping):
            below = table.setdefault(key, tomlkit.table())
            if isinstance(below, MutableMapping):
                _merge(below, value)
        else:
            table[key] = tomlkit.integer(f"{value:_}") if isinstance(value, int) else value


def _prune(table: MutableMapping[str, Any], values: Mapping[str, Any]) -> None:
    """Remove the cores and rows that are no longer in `values`."""
    for key in set(table) - set(values):
        del table[key]
    for core in values:
        for row in set(table[core]) - set(values[core]):
            del table[core][row]
