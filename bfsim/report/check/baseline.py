"""The baseline file: TOML, one `[[run]]` for each configuration that is checked.

`require` is written by a person. `limits`, `kernels` and `measured_on` are written by `--update`, whole.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import tomlkit
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from tomlkit import TOMLDocument
from tomlkit.exceptions import TOMLKitError

from bfsim.errors import ConfigError, cut, shown
from bfsim.report.check.requirement import Requirement, parse_requirement
from bfsim.trace import Identity

Percent = Annotated[float, Field(ge=0, le=100, allow_inf_nan=False)]
OLD_KEYS = {"core", "measured_by", "tolerance_percent"}
"""At the top of files that were written before there were several runs in one."""

COMPARABLE = ("recording", "frames", "board", "compiler", "script")
"""Of what limits were measured on, what a run must have in common with them."""


class _Table(BaseModel):
    """A TOML table: no unknown keys, no conversions."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Configuration(_Table):
    """What to run, as the options of `bfsim run` say it; what is not there is the default. Paths are relative to the file."""

    recording: str = ""
    firmware: str = ""
    board: str = ""
    set: dict[str, str] = {}
    ldf: str = ""
    define: dict[str, str] = {}
    include: list[str] = []
    profile: str = ""
    frames: Annotated[int, Field(ge=1)] | None = None
    feed: Literal["demand", "recorded", "cameras"] = "demand"
    script: str = ""
    fidelity: Literal["fast", "detailed"] = "fast"


class MeasuredOn(_Table):
    """What the limits were measured on: digests (sha256), sizes and versions."""

    recording: str
    frames: int
    board: str
    compiler: str
    script: str
    firmware: str
    ldf: str
    bfsim_version: str
    llvm_version: str


class Case(Configuration):
    """One `[[run]]`: a configuration and its limits. The tolerances are for `limits`; results may differ either way."""

    name: Annotated[str, Field(min_length=1)]
    tolerance_percent: Percent = 0
    results_tolerance_percent: Percent = 0
    require: list[str] = []
    limits: list[str] = []
    loosened: list[str] = []
    kernels: dict[str, dict[str, dict[str, int]]] = {}
    measured_on: MeasuredOn | None = None

    @property
    def configuration(self) -> Configuration:
        """What is run."""
        return Configuration(**{key: getattr(self, key) for key in Configuration.model_fields})


class Baseline(_Table):
    """The whole file."""

    run: list[Case] = []


def read_baseline(path: Path) -> Baseline:
    """Read a baseline file. Raises ConfigError that names the file, the key and what must be there."""
    if not path.exists():
        raise ConfigError(f"{path} must be a baseline file, but there is none: make it with --update")
    return validated(parsed(path), path)


def measured_on(identity: Identity, frames: int) -> MeasuredOn:
    """Return what a run of so many frames, missed ones included, is measured on."""
    return MeasuredOn(
        recording=identity.recording_digest,
        frames=frames,
        board=identity.board_digest,
        compiler=identity.compiler_digest,
        script=identity.script_digest,
        firmware=identity.firmware_digest,
        ldf=identity.ldf_digest,
        bfsim_version=identity.bfsim_version,
        llvm_version=identity.llvm_version,
    )


def parsed(path: Path) -> TOMLDocument:
    """Return a file as TOML. Raises ConfigError."""
    try:
        return tomlkit.parse(path.read_text(encoding="utf-8"))
    except (TOMLKitError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path} must be TOML: {cut(str(error))}") from error
    except OSError as error:
        raise ConfigError(f"{path} must be a readable file: {error.strerror}") from error


def validated(document: TOMLDocument, path: Path) -> Baseline:
    """Return the baseline in a document from `path`, with every sentence in it read once."""
    plain = document.unwrap()
    if set(plain) & OLD_KEYS:
        raise ConfigError(
            f"{path} was written by an older bfsim, and must be made anew: move it away, run `bfsim check --baseline {path} "
            "--update` with your options, and copy your comments"
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
    """Say the first problem with its key, and by name in which run."""
    first = error.errors()[0]
    place, where = list(first["loc"]), ""
    runs = plain.get("run")
    if place[:1] == ["run"] and len(place) > 1 and isinstance(place[1], int) and isinstance(runs, list):
        entry = runs[place[1]]
        name = entry.get("name") if isinstance(entry, dict) else None
        where = f"run {shown(name) if isinstance(name, str) else place[1] + 1}, "
        place = place[2:]
    key = cut(".".join(map(str, place))) or "it"
    match first["type"]:
        case "missing":
            return ConfigError(f"{path}: {where}the key {key} must be there")
        case "extra_forbidden":
            known = ", ".join(Case.model_fields if where else Baseline.model_fields)
            return ConfigError(f"{path}: {where}{key} must not be there; known keys are {known}")
    must_be = (
        first["msg"].replace("Input should", "must").partition(" or instance of")[0].removesuffix(" instance")
    )
    return ConfigError(f"{path}: {where}{key} {must_be}, not {shown(first['input'])}")
