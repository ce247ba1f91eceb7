"""The page of a difference: from the stage to the cause, and the most changed frames with their pictures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from bfsim.report.budget.times import milliseconds
from bfsim.report.diff.cells import cells, in_short, labelled, listed
from bfsim.report.diff.difference import Difference
from bfsim.report.diff.scope import frames_compared, scope, seen_lines
from bfsim.report.diff.sentences import verdict, why
from bfsim.report.html.rendering import rendered
from bfsim.report.html.undrawn import UndrawnFrames

FRAMES = 5
"""The number of the most changed frames that are shown."""


@dataclass(frozen=True, slots=True)
class PagedSide:
    """One side of the comparison: its name, and its frames if it was run for the page. A side from a file has none."""

    name: str
    frames: UndrawnFrames | None

    def picture_uri(self, index: int) -> str:
        """Return the picture of what was seen in a frame as a data URI; "" if there is none."""
        return self.frames.picture_uri(index) if self.frames else ""


@dataclass(frozen=True, slots=True)
class DiffPage:
    """Everything that a page shows of the comparison of two runs."""

    difference: Difference
    before: PagedSide
    after: PagedSide

    def chunks(self) -> Iterator[str]:
        """Yield the page as HTML, piece by piece."""
        difference = self.difference
        largest_cclk = max((abs(each.cclk) for each in difference.stages), default=0)
        return rendered(
            "diff.html",
            {
                "difference": difference,
                "sides": {"before": self.before, "after": self.after},
                "verdict": verdict(difference).replace(" %", "\N{NO-BREAK SPACE}%"),
                "why": list(why(difference)),
                "scope": list(scope(difference)),
                "configuration": list(in_short(difference.configuration)),
                "compared": frames_compared(difference),
                "labelled": labelled,
                "listed": listed,
                "cells": cells,
                "half": lambda cclk: f"{50 * abs(cclk) / largest_cclk:.2f}" if largest_cclk else "0",
                "frames": difference.changed_frames[:FRAMES],
                "before_ms": lambda cclk: milliseconds(cclk, difference.before_cclk_hz),
                "after_ms": lambda cclk: milliseconds(cclk, difference.after_cclk_hz),
                "seen": list(seen_lines(difference)),
            },
        )
