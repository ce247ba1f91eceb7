"""What `bfsim place` has found, as records: what moved, what each memory holds, and every placement that was run."""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.trace import Identity

NEAR_CAMERA = 1.01
"""The cameras bound a frame that takes up to so many times the time between two pictures."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """A placement that was run: the frame time that the model predicted for it, and the simulated one.

    `busy_ms`: the part of it that the busiest core does not wait for pictures or the other core.
    """

    predicted_ms: float
    simulated_ms: float
    busy_ms: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedPart:
    """A buffer, or the code of a kernel. `before` and `after` are segments of the LDF.

    `core` is that which it belongs to, or "shared". Accesses are those of all cores a frame; `streamed`: DMA moves it, too.
    `saved_ms`: what the cores wait less for it in a frame.
    """

    name: str
    core: str
    is_code: bool
    nbytes: int
    before: str
    after: str
    reads: float
    writes: float
    streamed: bool
    saved_ms: float
    why: str

    @property
    def has_moved(self) -> bool:
        """Whether it lies elsewhere than before."""
        return self.before != self.after


@dataclass(frozen=True, slots=True, kw_only=True)
class Fill:
    """How full a memory of the chip is, before and after."""

    memory: str
    nbytes: int
    before_bytes: int
    after_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Placed:
    """The best placement that was run. `identity` is that of the first run; `start` names the LDF whose memories they are.

    `linked`: whether that LDF had room for the firmware; else the first run had what it had no room for elsewhere.
    `camera_ms`: the time between two pictures, below which no placement comes; `..._busy_ms` as in a trial. `best`:
    number of the trial, None if the first run was not beaten. `ldf` is the text of the placement, empty where nothing
    is better than what was given.
    """

    identity: Identity
    start: str
    linked: bool
    frames: int
    before_ms: float
    before_busy_ms: float
    camera_ms: float
    trials: tuple[Trial, ...]
    best: int | None
    parts: tuple[PlacedPart, ...]
    fills: tuple[Fill, ...]
    ldf: str

    @property
    def predicted_ms(self) -> float:
        """The predicted frame time of the best placement."""
        return self.before_ms if self.best is None else self.trials[self.best].predicted_ms

    @property
    def after_ms(self) -> float:
        """The simulated frame time of the best placement."""
        return self.before_ms if self.best is None else self.trials[self.best].simulated_ms
