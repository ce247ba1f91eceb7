"""The file of a sweep: TOML with `[base]`, `[axes]` and `[[point]]`, read as points: runs with options."""

from __future__ import annotations

import glob
import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from bfsim.errors import ConfigError, cut, printable, shown
from bfsim.files.content import read_bounded
from bfsim.report.check.baseline import Configuration
from bfsim.report.check.settings import written
from bfsim.sweeping.options import SCRIPT, Options, configured, flattened, merged

MOST_POINTS = 100_000
"""More would take years."""

BASE, AXES, POINT = "base", "axes", "point"
BASELINE_KEY = "run"
"""A key at the top of a baseline of `bfsim check`, which is TOML, too."""
RECORDING, CONFIGURATION, NAME = "recording", "configuration", "name"


@dataclass(frozen=True, slots=True)
class Point:
    """One run of a sweep: `options` are its options in the file.

    `setting` distinguishes it in words from others with the same recording, and `recording` from others with the same
    setting; either is empty if there is only one.
    """

    configuration: Configuration
    options: Options
    setting: str
    recording: str

    @property
    def name(self) -> str:
        """Its name in words."""
        return " ".join(filter(None, [self.recording, self.setting])) or BASE


@dataclass(frozen=True, slots=True)
class _Choice:
    """A value of an axis, or a point of its own: the options that it adds to the base, and its words."""

    options: Options
    words: str


def read_sweep(path: Path, scripts: Path) -> list[Point]:
    """Return the points of a file: those of the axes, the last axis varying fastest, and then each `[[point]]`.

    Paths in the file are relative to it. A script inside the file is written to the folder `scripts`. Raises
    ConfigError that names file and key.
    """
    try:
        plain = tomllib.loads(read_bounded(path).decode("utf-8-sig"))
    except OSError as error:
        raise ConfigError(f"{path} must be a readable file: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise ConfigError(f"{path} must be TOML: {cut(str(error))}") from error
    try:
        points = list(_points(plain, path.parent, scripts))
        _require_apart(points)
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from error
    return points


def _require_apart(points: Sequence[Point]) -> None:
    """Raise ConfigError if two points are the same, or have the same name but differ in more than the recording."""
    settings, known = dict[str, Options](), set[tuple[str, object]]()
    for point in points:
        setting = {key: value for key, value in point.options.items() if key != RECORDING}
        if settings.setdefault(point.setting, setting) != setting:
            raise ConfigError(
                f"different points must have different names, but two are called {shown(point.name)}"
            )
        run = point.setting, point.options.get(RECORDING)
        if run in known:
            raise ConfigError(f"each point must be listed once, not twice: {shown(point.name)}")
        known.add(run)


def _points(plain: Mapping[str, Any], folder: Path, scripts: Path) -> Iterator[Point]:
    if isinstance(plain.get(BASELINE_KEY), list):
        raise ConfigError(
            f"it must be a sweep, with [{AXES}] or [[{POINT}]], not a baseline of `bfsim check`"
        )
    for key in plain:
        if key not in {BASE, AXES, POINT}:
            raise ConfigError(f"{cut(key)} must not be there; known are [{BASE}], [{AXES}] and [[{POINT}]]")
    base = flattened(plain.get(BASE, {}), BASE)
    axes = dict(_axes(plain.get(AXES, {}), folder))
    own = [*_tables(plain.get(POINT, []), POINT)]
    if not axes and not own:
        raise ConfigError(f"there must be a list in [{AXES}], or a [[{POINT}]]")
    count = len(own) + (math.prod(map(len, axes.values())) if axes else 0)
    if count > MOST_POINTS:
        raise ConfigError(f"there must be at most {MOST_POINTS:,} points, not {count:,}")
    for choices in product(*axes.values()) if axes else ():
        yield _point(base, dict(zip(axes, choices, strict=True)), axes, folder, scripts)
    for choice in own:
        yield _point(base, {POINT: choice}, {POINT: own, **axes}, folder, scripts)


def _point(
    base: Options,
    chosen: Mapping[str, _Choice],
    axes: Mapping[str, Sequence[_Choice]],
    folder: Path,
    scripts: Path,
) -> Point:
    options, by = base, dict[str, str]()
    for key in sorted(chosen, key=lambda each: each.count(".")):
        for path in chosen[key].options:
            if by.setdefault(path, key) != key:
                raise ConfigError(f"{cut(path)} must be in one axis, not in both {by[path]} and {cut(key)}")
        options = merged(options, chosen[key].options)
    words = {key: each.words for key, each in chosen.items() if len(axes[key]) > 1 or key == POINT}
    recording = words.pop(RECORDING, "")
    setting = printable(" ".join(words.values()))
    try:
        configuration = configured(options, folder, scripts)
    except ConfigError as error:
        raise ConfigError(f"point {shown(setting or BASE)}: {error}") from error
    return Point(configuration, options, setting, printable(recording))


def _axes(table: object, folder: Path) -> Iterator[tuple[str, list[_Choice]]]:
    """Yield the choices of each axis by its path."""
    if not isinstance(table, dict):
        raise ConfigError(f"{AXES} must be a table of lists, not {shown(table)}")
    rest = {key: value for key, value in table.items() if key != CONFIGURATION}
    axes = flattened(rest, AXES)
    short = dict(zip(axes, _short(list(axes)), strict=True))
    for path, values in axes.items():
        if not isinstance(values, list) or not values:
            raise ConfigError(f"{AXES}.{cut(path)} must be a list of values, not {shown(values)}")
        found = _files(values, folder) if path == RECORDING else values
        yield path, [_Choice(_one(path, value), _words(path, short[path], value)) for value in found]
    if CONFIGURATION in table:
        yield CONFIGURATION, [*_tables(table[CONFIGURATION], f"{AXES}.{CONFIGURATION}")]


def _one(path: str, value: object) -> Options:
    """Return the options for one value of an axis; a table under `script` may stand for its entries."""
    if isinstance(value, dict) and path == SCRIPT:
        return {f"{SCRIPT}.{key}": each for key, each in value.items()}
    return {path: value}


def _words(path: str, short: str, value: object) -> str:
    return written(value) if path == RECORDING else f"{short}={written(value)}"


def _short(paths: Sequence[str]) -> Iterator[str]:
    """Yield the end of each path, with as many names as distinguish it from the others."""
    for path in paths:
        names = path.split(".")
        ends = [".".join(names[-count:]) for count in range(1, len(names) + 1)]
        yield next(
            end
            for end in ends
            if end == path or not any(f".{other}".endswith(f".{end}") for other in paths if other != path)
        )


def _tables(tables: object, where: str) -> Iterator[_Choice]:
    """Yield the choices in a list of tables; each may have a name."""
    if not isinstance(tables, list):
        raise ConfigError(f"{where} must be a list of tables, [[{where}]], not {shown(tables)}")
    for number, table in enumerate(tables, 1):
        name = table.get(NAME, "") if isinstance(table, dict) else ""
        if not isinstance(name, str) or (name and not name.strip()):
            raise ConfigError(f"{where}.{number}.{NAME} must be text, not {shown(name)}")
        rest = (
            {key: value for key, value in table.items() if key != NAME} if isinstance(table, dict) else table
        )
        options = flattened(rest, f"{where}.{number}")
        said = " ".join(f"{key.removeprefix('set.')}={written(value)}" for key, value in options.items())
        yield _Choice(options, name or said or BASE)


def _files(patterns: Sequence[object], folder: Path) -> list[object]:
    """Return the files for patterns such as drives/*.mcap, sorted and without duplicates; plain names stay as they are."""
    files: list[object] = []
    for each in patterns:
        if not isinstance(each, str) or not glob.has_magic(each) or (folder / each).exists():
            files.append(each)
            continue
        found = sorted(glob.glob(each, root_dir=folder, recursive=True))  # noqa: PTH207 - takes absolute ones, too
        if not found:
            raise ConfigError(f"{AXES}.{RECORDING} must match a file, and {shown(each)} matches none")
        files += found
    once: dict[object, object] = {}
    for each in files:
        there = folder / each if isinstance(each, str) else None
        once.setdefault(there.resolve() if there and there.exists() else repr(each), each)
    return [*once.values()]
