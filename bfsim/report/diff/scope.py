"""Which parts of two runs are compared, and what only one of them saw, in sentences."""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.report.diff.difference import Difference


def scope(difference: Difference) -> Iterator[str]:
    """Yield what to know if the frames of the two runs are not the same."""
    if difference.measured_frames != len(difference.frames):
        yield (
            f"The first side is of {difference.measured_frames} frames, the second of {len(difference.frames)}: cycles of "
            "the first are in proportion."
        )
    if not difference.has_lines:
        yield (
            f"The runs do not have the same frames: {len(difference.frames)} are in both, and cycles are of these, "
            "without source lines."
        )


def frames_compared(difference: Difference) -> str:
    """Return the number of frames that are compared, in words."""
    count = len(difference.frames)
    return f"{count} frame{'s' if count > 1 else ''}"


def seen_lines(difference: Difference) -> Iterator[str]:
    """Yield sentences about what only one of the runs saw."""
    for each in difference.seen:
        frames = f"{each.frames} frame{'s' if each.frames > 1 else ''}, first in {each.first}"
        yield f"{each.name}: {'seen before, not any more' if each.gone else 'seen now, not before'}, in {frames}"
