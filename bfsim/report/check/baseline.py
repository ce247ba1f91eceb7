"""The baseline file: TOML, one `[[run]]` for each configuration that is checked.

A person writes `require`. `--update` writes `limits`, `costs` and `measured_on`, and replaces them whole.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

from bfsim.report.check.requirement_reading import MOST_FRAMES
from bfsim.report.check.settings import leaves, text_of
from bfsim.trace import Identity

Percent = Annotated[float, Field(ge=0, le=100, allow_inf_nan=False)]
Whole = Annotated[int, Field(gt=-(1 << 63), lt=1 << 63)]
"""Cycles and times: more than 64 bits would not fit among floats."""

COMPARABLE = ("recording", "frames", "board", "compiler", "code", "file_compiler", "script")
"""Parts of what limits were measured on that must be the same for a run to be compared with them."""


class Table(BaseModel):
    """A TOML table: no unknown keys, no conversions."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Configuration(Table):
    """What to run, in terms of `bfsim run`'s options, with their defaults. Paths are relative to the file."""

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
        """Return tables and numbers as text by paths; leave anything else as it is, for the error."""
        if not isinstance(given, Mapping):
            return given
        found = ((path, value, text_of(value)) for path, value in leaves(given))
        return {path: value if text is None else text for path, value, text in found}


class MeasuredOn(Table):
    """What the limits were measured on: digests (sha256), sizes and versions.

    `code` says in words whose object code the kernels ran as, since the code itself changes with each edit of the
    firmware. It is empty if the compiler is an estimate. `file_compiler` is what compiled kernels in C, empty without
    any. Both are empty in files from before they were kept, and the size of the pictures is 0 in older ones.
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
        """Whether two runs differ in a key of COMPARABLE.

        A board or compiler with equal numbers is the same, whatever its file says; code differs only if both have some.
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


class KeptLine(Table):
    """A source line of a kernel; its fields are those of `diff.side.Line`, stalls are named REASON or REASON, BUFFER."""

    text: str
    times: Whole
    operations: dict[str, Annotated[list[Whole], Field(min_length=2, max_length=2)]] = {}
    stalls: dict[str, Whole] = {}


class KeptOwner(Table):
    """An owner of cycles in a stage; its fields are those of `diff.side.Owner` and `Source`."""

    stage: str
    owner: str
    symbol: str = ""
    place: str = ""
    cclk: Whole
    lines: list[KeptLine] = []


class Costs(Table):
    """What the run cost when its limits were measured, to explain a failure. Its fields are those of `diff.side.Side`."""

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
        """Whether the file has what the run cost when its limits were measured."""
        return self.costs is not None and self.measured_on is not None

    @property
    def configuration(self) -> Configuration:
        """What to run."""
        return Configuration(**{key: getattr(self, key) for key in Configuration.model_fields})


class Baseline(Table):
    """The whole file."""

    run: list[Case] = []


def measured_on(identity: Identity, frames: int) -> MeasuredOn:
    """Return what a run was measured on; `frames` includes missed ones."""
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
