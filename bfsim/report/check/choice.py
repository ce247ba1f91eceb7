"""The choice of runs from a baseline file for a command."""

from __future__ import annotations

import difflib
import os
from pathlib import Path

from bfsim.errors import ConfigError, shown
from bfsim.report.check.baseline import Baseline, Case, Configuration
from bfsim.report.check.update import DEFAULT_TOLERANCE_PERCENT


def chosen(
    baseline: Baseline,
    path: Path,
    given: Configuration | None,
    name: str | None,
    own_name: str,
    *,
    update: bool,
) -> list[Case]:
    """Return the runs that a name or the `given` configuration stands for; without either, all.

    With `update`, a run that does not exist is added, as `name` or under its `own_name`. Raises ConfigError if no run
    matches.
    """
    if name is None and given is None and baseline.run:
        return list(baseline.run)
    named = next((case for case in baseline.run if case.name == name), None)
    if named:
        if given is None:
            return [named]
        if update:
            return [named.model_copy(update=dict(given))]
        if not _different(named, given, path):
            return [named]
        raise ConfigError(
            f"{path}: run {shown(name)} says itself what to run: {_differences(named, given, path)}; leave the options out, or "
            "change it with --update"
        )
    same = [case for case in baseline.run if given is not None and not _different(case, given, path)]
    if name is None and same:
        return same
    if not update:
        raise ConfigError(_nothing_meant(baseline, path, given, name))
    added = Case(
        name=name or own_name,
        tolerance_percent=DEFAULT_TOLERANCE_PERCENT,
        **dict(given or Configuration()),
    )
    if any(case.name == added.name for case in baseline.run):
        raise ConfigError(
            f"{path}: --case NAME must give the new run another name than {shown(added.name)}, which is one already"
        )
    return [added]


def _nothing_meant(baseline: Baseline, path: Path, given: Configuration | None, name: str | None) -> str:
    if not baseline.run:
        return f"{path} must have a [[run]] to check; --update adds one"
    names = [case.name for case in baseline.run]
    if name is not None:
        nearest = difflib.get_close_matches(name, names, n=4, cutoff=0)
        return (
            f"{path}: --case must name one of its {len(names)} runs, not {shown(name)}; the nearest are "
            f"{', '.join(map(shown, nearest))}; --update adds a new one"
        )
    assert given is not None
    nearest_case = min(baseline.run, key=lambda case: len(_different(case, given, path)))
    return (
        f"{path} must have a run of these options; the nearest, {shown(nearest_case.name)}, differs: "
        f"{_differences(nearest_case, given, path)}; --update adds one, and without options all runs in the file are checked"
    )


def _different(case: Case, given: Configuration, path: Path) -> list[str]:
    """Return the keys in which a run differs from what is given; two paths to one file are the same."""
    return [
        key
        for key in Configuration.model_fields
        if _placed(getattr(case, key), path) != _placed(getattr(given, key), path)
    ]


def _placed(value: object, path: Path) -> object:
    """Return a value with absolute paths in place of names, which are relative to the file at `path`."""
    if isinstance(value, list):
        return [_placed(each, path) for each in value]
    return os.path.abspath(path.parent / value) if isinstance(value, str) and value else value  # noqa: PTH100 - of no link


def _differences(case: Case, given: Configuration, path: Path) -> str:
    return ", ".join(
        f"{key} is {shown(getattr(case, key)) if getattr(case, key) else 'the default'} there and "
        f"{shown(getattr(given, key)) if getattr(given, key) else 'the default'} here"
        for key in _different(case, given, path)
    )
