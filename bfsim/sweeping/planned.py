"""A point of a sweep before it runs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from bfsim.sweeping.file import Point
from bfsim.sweeping.running import code_digest
from bfsim.sweeping.store import key_of
from bfsim.trace import Identity


@dataclass(frozen=True, slots=True)
class Planned:
    """A point before it runs: everything that its result depends on, and the `key` of that; or an `error`."""

    point: Point
    identity: Identity | None = None
    frames: int = 0
    key: str = ""
    error: str = ""

    @property
    def work(self) -> int:
        """The amount to simulate, in pixels."""
        return self.frames * self.identity.width_px * self.identity.height_px if self.identity else 0

    @property
    def kind(self) -> tuple[str, ...]:
        """What determines how long a pixel takes: firmware, LDF and compiler."""
        it = self.identity
        return (it.firmware_digest, it.ldf_digest, it.compiler_digest) if it else ()


def planned_point(
    point: Point, known: tuple[Identity, int] | str, digests: dict[tuple[Path, int], str], recording: Path
) -> Planned:
    """Return a planned point from what is `known` of its run, or why there is none, and the digests of recordings."""
    if isinstance(known, str):
        return Planned(point, error=known)
    identity, frames = known
    digest = digests[recording, frames]
    if not digest:
        return Planned(point, error=f"{recording} must have {frames} frames that can be read")
    identity = replace(identity, recording_digest=digest)
    return Planned(point, identity, frames, key_of(identity, code_digest()))
