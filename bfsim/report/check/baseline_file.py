"""Read a baseline file, with errors that name the run and the key."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit
from pydantic import ValidationError
from tomlkit import TOMLDocument
from tomlkit.exceptions import TOMLKitError

from bfsim.errors import ConfigError, cut, shown
from bfsim.files.content import read_bounded
from bfsim.files.wrong_value import key_of, wrong_value
from bfsim.report.check.baseline import Baseline, Case, Costs, KeptLine, KeptOwner, MeasuredOn, Table
from bfsim.report.check.requirement import Requirement
from bfsim.report.check.requirement_reading import parse_requirement

OLD_KEYS = {"core", "measured_by", "tolerance_percent"}
"""Keys at the top of files from before a file could hold several runs."""

SWEEP_KEYS = {"base", "axes", "point"}
"""Keys at the top of files for `bfsim sweep`, which are TOML, too."""

TABLES: dict[int | str, type[Table]] = {
    "measured_on": MeasuredOn, "costs": Costs, "of": KeptOwner, "lines": KeptLine,
}  # fmt: skip
"""The parts of a run, by the keys that lead to them."""
WRITTEN = (["limits"], ["measured_on"], ["costs"])
"""Keys of a run that `--update` writes."""


def read_baseline(path: Path) -> Baseline:
    """Read a baseline file. Raises ConfigError that names the file, the key and what belongs there."""
    if not path.exists():
        raise ConfigError(
            f"{path} must be a baseline file, but there is none: `bfsim check --update` makes it"
        )
    return validated(parsed(path), path)


def measured_case(path: Path, name: str) -> Case:
    """Return a run of a baseline file, by its name or as the only one.

    Raises ConfigError if there is none, or if it has no limits yet.
    """
    cases = read_baseline(path).run
    named = [case for case in cases if case.name == name or not name]
    if len(named) != 1:
        known = ", ".join(shown(case.name) for case in cases) or "none"
        what = (
            f"{path} must have a run called {shown(name)}"
            if name
            else f"{path}:NAME must name one of its runs"
        )
        raise ConfigError(f"{what}; they are {known}")
    if not named[0].has_costs:
        raise ConfigError(f"{path}: run {shown(named[0].name)} must have been measured: --update does that")
    return named[0]


def update_command(path: Path, name: str = "") -> str:
    """Return the shell command that makes new limits for a run, or for all, from what is measured."""
    return shlex.join(
        ["bfsim", "check", "--baseline", str(path), *(["--case", name] if name else []), "--update"]
    )


def parsed(path: Path) -> TOMLDocument:
    """Return a file as TOML. Raises ConfigError if it is not TOML."""
    try:
        return tomlkit.parse(read_bounded(path).decode("utf-8-sig"))
    except (TOMLKitError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path} must be TOML: {cut(str(error))}") from error
    except OSError as error:
        raise ConfigError(f"{path} must be a readable file: {error.strerror}") from error


def validated(document: TOMLDocument, path: Path) -> Baseline:
    """Return the baseline in a document from `path`. Raises ConfigError for a wrong key, value or sentence in it."""
    plain = document.unwrap()
    runs = plain.get("run")
    cases = [each for each in runs if isinstance(each, dict)] if isinstance(runs, list) else []
    if set(plain) & OLD_KEYS or any("kernels" in each for each in cases):
        raise ConfigError(
            f"{path} was written by an older bfsim, and must be made anew: move it away, run `{update_command(path)}` "
            "with your options, and copy your comments"
        )
    if set(plain) & SWEEP_KEYS and "run" not in plain:
        raise ConfigError(
            f"{path} must be a baseline of `bfsim check`, not a file of `bfsim sweep`; points of that are compared by "
            "what would stand behind `bfsim run`"
        )
    try:
        baseline = Baseline.model_validate(plain)
    except ValidationError as error:
        raise _told(error, plain, path) from error
    names = [case.name for case in baseline.run]
    for name in names:
        if names.count(name) > 1:
            raise ConfigError(
                f"{path}: each run must have a name of its own, but two are called {shown(name)}"
            )
    for case in baseline.run:
        requirements_of(case, path)
    return baseline


def requirements_of(case: Case, path: Path) -> tuple[list[Requirement], list[Requirement]]:
    """Return what a person requires of a run, and the limits that were measured."""
    return tuple(  # type: ignore[return-value]  # two of them
        [parse_requirement(text, f"{path}: run {shown(case.name)}, {key}") for text in getattr(case, key)]
        for key in ("require", "limits")
    )


def _told(error: ValidationError, plain: Mapping[str, Any], path: Path) -> ConfigError:
    """Return the first problem as an error, with its key and the name of the run."""
    first = error.errors()[0]
    place, where = list(first["loc"]), ""
    runs = plain.get("run")
    if place[:1] == ["run"] and len(place) > 1 and isinstance(place[1], int) and isinstance(runs, list):
        entry = runs[place[1]]
        name = entry.get("name") if isinstance(entry, dict) else None
        where = f"run {shown(name) if isinstance(name, str) else place[1] + 1}, "
        place = place[2:]
    key = key_of(place) or "it"
    advice = f"; --update writes {place[0]} anew once it is removed" if place[:1] in WRITTEN else ""
    match first["type"]:
        case "missing":
            return ConfigError(f"{path}: {where}the key {key} must be there{advice}")
        case "extra_forbidden":
            tables = [TABLES[each] for each in place[:-1] if each in TABLES]
            known = ", ".join((tables[-1] if tables else Case if where else Baseline).model_fields)
            return ConfigError(f"{path}: {where}{key} must not be there; known keys are {known}{advice}")
    return ConfigError(f"{path}: {where}{key} {wrong_value(first)}{advice}")
