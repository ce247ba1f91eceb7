"""Read back the results of earlier runs: the files that `bfsim run --json` writes."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import cache
from math import inf
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from bfsim.errors import ConfigError, cut, shown
from bfsim.files.content import read_bounded
from bfsim.files.wrong_value import key_of, wrong_value
from bfsim.report.budget.owners import OwnerFrames
from bfsim.report.results.as_json import SCHEMA
from bfsim.report.results.result import Result
from bfsim.trace import RunRecord, WarningKind

LARGEST, LONGEST_NUMBER = (1 << 63) - 1, 20
"""The largest whole number, and the most characters of one, with its sign."""
OWNERS = "owners"
"""The key of the owners of cycles."""


def read_result(path: Path) -> Result:
    """Read a file of `bfsim run --json`. Raises ConfigError that names the file, the key and what belongs there."""
    plain = _plain(path)
    if plain.get("schema") != SCHEMA:
        raise ConfigError(
            f"{path} must be a result of this version of bfsim, schema {SCHEMA}, not {shown(plain.get('schema'))}: "
            "write it again with `bfsim run --json`"
        )
    try:
        run = _records().validate_python({**plain, "assumptions": _assumptions(plain)})
        owners = _owners().validate_python({OWNERS: plain.get(OWNERS)})[OWNERS]
    except ValidationError as error:
        first = error.errors()[0]
        raise ConfigError(f"{path}: {key_of(first['loc'])} {wrong_value(first)}") from None
    for wrong in _wrong(run, owners):
        raise ConfigError(f"{path}: {wrong}")
    return Result(run, {each["index"]: each["seen"] for each in plain["frames"] if "seen" in each}, owners)


def _wrong(run: RunRecord, owners: tuple[OwnerFrames, ...]) -> Iterator[str]:
    """Yield what no run produces, and what no report can use."""
    if not run.frames:
        yield "frames must be at least one, and there is none"
    if not all(each.cores for each in run.frames):
        yield "frames must have what at least one core did in each"
    for name, hz in (("cclk_hz", run.identity.cclk_hz), ("sclk_hz", run.identity.sclk_hz)):
        if not 0 < hz < inf:
            yield f"identity.{name} must be a rate in Hz, not {hz}"
    if any({len(each.elapsed_cclk), len(each.waiting_cclk)} != {len(run.frames)} for each in owners):
        yield f"owners must have a number for each of the {len(run.frames)} frames"


def _plain(path: Path) -> dict[str, Any]:
    try:
        plain = json.loads(read_bounded(path, most_mb=512), parse_int=_whole)
    except FileNotFoundError:
        raise ConfigError(
            f"{path} must be a result of `bfsim run --json`, but there is no such file"
        ) from None
    except (ValueError, RecursionError) as error:
        raise ConfigError(f"{path} must be JSON as `bfsim run --json` writes it: {cut(str(error))}") from None
    except OSError as error:
        raise ConfigError(f"{path} must be a readable file: {error.strerror}") from error
    if not isinstance(plain, dict):
        raise ConfigError(f"{path} must be a result of `bfsim run --json`, not {shown(plain)}")
    return plain


def _whole(digits: str) -> int:
    """Return a whole number of at most 64 bits: larger ones do not fit among floats."""
    number = int(digits) if len(digits) <= LONGEST_NUMBER else LARGEST + 1
    if abs(number) > LARGEST:
        raise ValueError(f"a number must have at most 64 bits, not be {digits[:LONGEST_NUMBER]}")
    return number


@cache
def _records() -> TypeAdapter[RunRecord]:
    return TypeAdapter(RunRecord)


@cache
def _owners() -> TypeAdapter[dict[str, tuple[OwnerFrames, ...]]]:
    return TypeAdapter(dict[str, tuple[OwnerFrames, ...]])


def _assumptions(plain: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return the warnings that cannot be derived from other records."""
    warnings = plain.get("warnings")
    kinds = {WarningKind.GEOMETRY.value, WarningKind.CLOCKS.value, WarningKind.TABLES.value}
    return [
        {"kind": each["kind"], "text": str(each.get("text"))}
        for each in (warnings if isinstance(warnings, list) else [])
        if isinstance(each, dict) and each.get("kind") in kinds
    ]
