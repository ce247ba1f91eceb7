"""Who watches a run: what is to be called before it, while it goes on, and when it is done."""

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
    """What is to be called, each list in its order; nothing that they do changes a cycle.

    `before` the first frame with what will run and how many frames of it; with each frame that is `seen`; with `spans` of
    the timeline as they come; and with the records when the run is `done`, if a frame is.
    """

    before: list[Callable[[Identity, int], None]] = field(default_factory=list)
    seen: list[Callable[[SeenFrame], None]] = field(default_factory=list)
    spans: list[Callable[[Sequence[Span]], None]] = field(default_factory=list)
    done: list[Callable[[RunRecord], None]] = field(default_factory=list)


def calling(each: Sequence[Callable[..., None]]) -> Callable[..., None] | None:
    """Return what calls them all; None if there is none, so that nobody makes what nobody wants."""

    def call(*arguments: object) -> None:
        for one in each:
            one(*arguments)

    return call if each else None
