"""The baseline file: TOML, one `[[run]]` for each configuration that is checked.

`require` is written by a person. `limits`, `costs` and `measured_on` are written by `--update`, whole.
"""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import tomlkit
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator
from tomlkit import TOMLDocument
from tomlkit.exceptions import TOMLKitError

from bfsim.errors import ConfigError, cut, shown
from bfsim.files.content import read_bounded
from bfsim.report.check.requirement import MOST_FRAMES, Requirement, parse_requirement
from bfsim.report.check.settings import leaves, text_of
from bfsim.report.wrong_value import key_of, wrong_value
from bfsim.trace import Identity

Percent = Annotated[float, Field(ge=0, le=100, allow_inf_nan=False)]
Whole = Annotated[int, Field(gt=-(1 << 63), lt=1 << 63)]
"""Of cycles and times: what has more than 64 bits has no place among floats."""
OLD_KEYS = {"core", "measured_by", "tolerance_percent"}
"""At the top of files that were written before there were several runs in one."""

COMPARABLE = ("recording", "frames", "board", "compiler", "code", "file_compiler", "script")
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

    @field_validator("set", "define", mode="before")
    @classmethod
    def _by_path(cls, given: object) -> object:
        """Return tables and numbers as text by paths; what can be neither stays as it is, for the error."""
        if not isinstance(given, Mapping):
            return given
        found = ((path, value, text_of(value)) for path, value in leaves(given))
        return {path: value if text is None else text for path, value, text in found}


class MeasuredOn(_Table):
    """What the limits were measured on: digests (sha256), sizes and versions.

    `code` is whose object code kernels ran as, in words: the code itself is another one with each edit of the firmware. It is empty where
    the compiler is an estimate, and `file_compiler`, what compiled kernels in C, where there are none; either is empty in files that were
    written before it was kept, and the size of the pictures, 0, in older ones.
    """

    recording: str
    frames: int
    board: str
    compiler: str
    script: str
    firmware: str
    ldf: str
    bfsim_version: str
    llvm_version: str
    code: str = ""
    file_compiler: str = ""
    width_px: int = 0
    height_px: int = 0
    board_numbers: list[str] = []
    compiler_numbers: list[str] = []

    def differs_in(self, key: str, other: MeasuredOn) -> bool:
        """Whether a key of COMPARABLE is another one's.

        A board or compiler with equal numbers is the same, whatever its file says; code is another where both have some.
        """
        if getattr(self, key) == getattr(other, key):
            return False
        if key in ("code", "file_compiler"):
            return bool(getattr(self, key) and getattr(other, key))
        numbers = f"{key}_numbers"
        are_known = numbers in MeasuredOn.model_fields and self.bfsim_version == other.bfsim_version
        return not (
            are_known and getattr(self, numbers) and getattr(self, numbers) == getattr(other, numbers)
        )


class KeptLine(_Table):
    """A source line of a kernel; its fields are those of `diff.side.Line`, a stall is called REASON or REASON, BUFFER."""

    text: str
    times: Whole
    operations: dict[str, Annotated[list[Whole], Field(min_length=2, max_length=2)]] = {}
    stalls: dict[str, Whole] = {}


class KeptOwner(_Table):
    """An owner of cycles in a stage; its fields are those of `diff.side.Owner` and `Source`."""

    stage: str
    owner: str
    symbol: str = ""
    place: str = ""
    cclk: Whole
    lines: list[KeptLine] = []


class Costs(_Table):
    """What the run cost when its limits were measured: with it a failure is explained. Its fields are those of `diff.side.Side`."""

    frames: Annotated[int, Field(ge=1, le=MOST_FRAMES)]
    frame_ms: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    cclk_hz: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    least_cclk: Whole
    frame_cclk: dict[Annotated[str, Field(pattern=r"^\d{1,9}$")], Whole] = {}
    waits: dict[str, Whole] = {}
    memories: dict[str, list[str]] = {}
    of: list[KeptOwner] = []


class Case(Configuration):
    """One `[[run]]`: a configuration and its limits. The tolerances are for `limits`; results may differ either way."""

    name: Annotated[str, Field(min_length=1)]
    tolerance_percent: Percent = 0
    results_tolerance_percent: Percent = 0
    require: list[str] = []
    limits: list[str] = []
    loosened: list[str] = []
    measured_on: MeasuredOn | None = None
    costs: Costs | None = None

    @property
    def has_costs(self) -> bool:
        """Whether it is kept what the run cost when its limits were measured."""
        return self.costs is not None and self.measured_on is not None

    @property
    def configuration(self) -> Configuration:
        """What is run."""
        return Configuration(**{key: getattr(self, key) for key in Configuration.model_fields})


class Baseline(_Table):
    """The whole file."""

    run: list[Case] = []


TABLES: dict[int | str, type[_Table]] = {
    "measured_on": MeasuredOn, "costs": Costs, "of": KeptOwner, "lines": KeptLine,
}  # fmt: skip
"""What is in a run, by the keys that lead there."""
WRITTEN = (["limits"], ["measured_on"], ["costs"])
"""Keys of a run that `--update` writes."""


def read_baseline(path: Path) -> Baseline:
    """Read a baseline file. Raises ConfigError that names the file, the key and what must be there."""
    if not path.exists():
        raise ConfigError(f"{path} must be a baseline file, but there is none: make it with --update")
    return validated(parsed(path), path)


def measured_case(path: Path, name: str) -> Case:
    """Return the run of that name in a baseline file, or its only one. Raises ConfigError if there is none, or it has no limits yet."""
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
        code=identity.code,
        file_compiler=identity.file_compiler,
        width_px=identity.width_px,
        height_px=identity.height_px,
        board_numbers=list(identity.board_numbers),
        compiler_numbers=list(identity.compiler_numbers),
    )


def update_command(path: Path, name: str = "") -> str:
    """Return the command that makes what is measured the limits of a run, or of all, as a shell takes it."""
    return shlex.join(
        ["bfsim", "check", "--baseline", str(path), *(["--case", name] if name else []), "--update"]
    )


def parsed(path: Path) -> TOMLDocument:
    """Return a file as TOML. Raises ConfigError."""
    try:
        return tomlkit.parse(read_bounded(path).decode("utf-8-sig"))
    except (TOMLKitError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path} must be TOML: {cut(str(error))}") from error
    except OSError as error:
        raise ConfigError(f"{path} must be a readable file: {error.strerror}") from error


def validated(document: TOMLDocument, path: Path) -> Baseline:
    """Return the baseline in a document from `path`, with every sentence in it read once."""
    plain = document.unwrap()
    runs = plain.get("run")
    cases = [each for each in runs if isinstance(each, dict)] if isinstance(runs, list) else []
    if set(plain) & OLD_KEYS or any("kernels" in each for each in cases):
        raise ConfigError(
            f"{path} was written by an older bfsim, and must be made anew: move it away, run `{update_command(path)}` "
            "with your options, and copy your comments"
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
