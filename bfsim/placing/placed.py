"""The result of `bfsim place` as records: what moved, how full each memory is, and every placement that was run."""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.trace import Identity

NEAR_CAMERA = 1.01
"""The cameras bound frames that take at most this many times the time between two pictures."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """A placement that was run: the frame time predicted by the model, and the simulated one.

    `busy_ms`: the part in which the busiest core does not wait for pictures or the other core.
    """

    predicted_ms: float
    simulated_ms: float
    busy_ms: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedPart:
    """A buffer, or the code of a kernel. `before` and `after` are segments of the LDF.

    `core` is its owner, or "shared". Accesses are those of all cores in a frame; `streamed`: DMA moves it, too.
    `saved_ms`: by how much the cores wait less for it in a frame.
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
    """The best placement that was run. `identity` is that of the first run; `start` names the LDF with the memories.

    `linked`: whether that LDF had room for the firmware; if not, the first run had some parts elsewhere. `camera_ms`:
    the time between two pictures, below which no placement can get; `..._busy_ms` as in a trial. `best`: the number of
    the trial, None if the first run was not beaten. `ldf` is the text of the placement, empty if nothing is better than
    the given one.
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
