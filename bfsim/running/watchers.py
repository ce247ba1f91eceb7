"""The watchers of a run: what is called before it, while it goes on, and when it is done."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # they take time to import
    from bfsim.seen import SeenFrame
    from bfsim.spans import Span
    from bfsim.trace import Identity, RunRecord


@dataclass(frozen=True, slots=True)
class Watchers:
    """Functions to call, each list in its order; nothing that they do changes a cycle.

    `before` gets what will run and how many frames of it, before the first frame; `seen` each frame; `spans` the
    timeline as it goes on; `done` the records at the end, if a frame was done.
    """

    before: list[Callable[[Identity, int], None]] = field(default_factory=list)
    seen: list[Callable[[SeenFrame], None]] = field(default_factory=list)
    spans: list[Callable[[Sequence[Span]], None]] = field(default_factory=list)
    done: list[Callable[[RunRecord], None]] = field(default_factory=list)


def calling(each: Sequence[Callable[..., None]]) -> Callable[..., None] | None:
    """Return a function that calls them all; None if there is none, so that nobody makes unwanted values."""

    def call(*arguments: object) -> None:
        for one in each:
            one(*arguments)

    return call if each else None
