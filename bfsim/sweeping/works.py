"""Recorded work in a sweep: one point records its run, so that others which differ only in the board can be played."""

from __future__ import annotations

import hashlib
import re
import shutil
import uuid
from collections.abc import Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Self

from bfsim.report.sweep.figures import SEEN
from bfsim.sweeping.running import MOST_WAITS, TRIED_FRAMES, Figures, Outcome, Work, code_digest

if TYPE_CHECKING:
    from bfsim.sweeping.planned import Planned
    from bfsim.sweeping.store import Store

WORKS = "works"
"""The folder in the store where each sweep has a folder of its own while it runs."""

LEAST_LEFT = 2
"""The least number of remaining points for the first of them to be recorded.

With all data of kernels in L1, another frame takes 23 ms to run, 35 ms to record and 8 ms to play (20 and 200 frames,
whole commands, the least of three): n remaining points gain from n = (35 - 8) / (23 - 8), 1.8, on.
"""

MANY_LEFT = 6
"""With at least this many points, a trial of the first one tells whether to record it at once."""

LEAST_FRAMES = 10 * TRIED_FRAMES
"""The least frames of a point for which a trial is short in comparison."""


@dataclass(slots=True)
class _Group:
    """Points with the same work: those that have not begun (`waiting`), and those that are not finished (`left`)."""

    path: Path
    frames: int
    waiting: set[str] = field(default_factory=set)
    left: set[str] = field(default_factory=set)
    pays: bool | None = None
    recorder: str = ""
    seen: Figures | None = None
    is_recorded: bool = False

    def learn(self, key: str, outcome: Outcome) -> None:
        """Note the outcome of a point."""
        if self.pays is None and outcome.figures:
            self.pays = outcome.waits <= MOST_WAITS
            self.seen = {name: value for name, value in outcome.figures.items() if name.startswith(SEEN)}
        if key == self.recorder:
            self.is_recorded = self.path.exists()


class Works(AbstractContextManager["Works"]):
    """The recorded work of one sweep. It is deleted at the end, as is the work of sweeps that were killed."""

    def __init__(self, store: Store, points: Iterable[Planned]) -> None:
        self._store = store
        self._own = uuid.uuid4().hex
        self._groups: dict[str, _Group] = {}
        groups: dict[str, _Group] = {}
        for each in points:
            if each.point.configuration.fidelity == "fast":
                name = work_of(each)
                group = groups.setdefault(
                    name, _Group(store.folder / WORKS / self._own / f"{name}.work", each.frames)
                )
                group.waiting.add(each.key)
                group.left.add(each.key)
                self._groups[each.key] = group

    def __enter__(self) -> Self:
        for each in (self._store.folder / WORKS).glob("*"):
            if re.fullmatch("[0-9a-f]{32}", each.name) and self._store.claim(each.name):
                shutil.rmtree(each, ignore_errors=True)
                self._store.release(each.name)
        self._store.claim(self._own)
        return self

    def __exit__(self, *_: object) -> None:
        shutil.rmtree(self._store.folder / WORKS / self._own, ignore_errors=True)
        self._store.release(self._own)

    def order(self, key: str) -> Work | None:
        """Return what a point that begins now is to record or to play; None if it just runs."""
        group = self._groups.get(key)
        if group is None:
            return None
        is_again = key not in group.waiting
        group.waiting.discard(key)
        if group.is_recorded:
            return Work(group.path, group.seen)
        is_first = len(group.waiting) == len(group.left) - 1
        tries = is_first and len(group.left) >= MANY_LEFT and group.frames >= LEAST_FRAMES
        pays = group.pays and len(group.waiting) >= LEAST_LEFT - 1
        if (pays or tries) and not group.recorder and not is_again:
            group.recorder = key
            group.path.parent.mkdir(parents=True, exist_ok=True)
            return Work(group.path, is_tried=not pays)
        return None

    def is_expected(self, key: str) -> bool:
        """Whether a recording for a point may exist soon: others had better run before it."""
        group = self._groups.get(key)
        if group is None or group.is_recorded or group.left == group.waiting:
            return False
        return group.pays is None or group.recorder in group.left

    def done(self, key: str, outcome: Outcome) -> None:
        """Learn from a point, and delete work that no point needs any more."""
        if group := self._groups.get(key):
            group.learn(key, outcome)
            group.waiting.discard(key)
            group.left.discard(key)
            if not group.left:
                group.path.unlink(missing_ok=True)


def work_of(planned: Planned) -> str:
    """Return a digest of all that the work of a run depends on: its identity without the board, and bfsim's code."""
    identity = planned.identity
    assert identity
    parts = (
        identity.recording_digest,
        identity.firmware,
        identity.firmware_digest,
        identity.compiler,
        identity.compiler_digest,
        identity.code_digest,
        identity.script_digest,
        identity.ldf_digest,  # other buffers outside L1 mean other work
        identity.feed,
        identity.llvm_version,
        code_digest(),
    )
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:32]
