"""The report of `bfsim record import`: how the pictures were fitted, and which were skipped."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from bfsim.errors import listed

if TYPE_CHECKING:
    from bfsim.recording.importing.importer import ImportSummary
    from bfsim.recording.importing.sources import Skipped

MOST_LISTED = 10
"""The most sizes and names in a list; the others are counted."""

LEAST_TOLD_CUT = 0.05
"""The part of a picture that may be cut off without mention."""


def fitted_text(summary: ImportSummary, *, is_scaled: bool) -> str:
    """Return the sizes from which pictures were scaled or cut, the share cut off, and which size keeps everything."""
    sizes = [f"{width}x{height}" for width, height in summary.source_sizes]
    text = f"{'Scaled by a triangle filter' if is_scaled else 'Cut'} from {listed(sizes, MOST_LISTED)}"
    cuts = [_part_cut_off(size, (summary.width, summary.height), is_scaled) for size in summary.source_sizes]
    if max(cuts) < LEAST_TOLD_CUT:
        return text
    if len(cuts) > 1:
        return f"{text}; up to {max(cuts):.0%} of a picture is cut off".replace("%", " %")
    text = f"{text}; {cuts[0]:.0%} of each is cut off".replace("%", " %")
    width, height = summary.source_sizes[0]
    kept = summary.width, max(2 * round(summary.width * height / width / 2), 2)
    if is_scaled and kept == (summary.width, summary.height):
        return text  # a few pixels; no other even height is nearer to the shape
    return f"{text}, `--resize {kept[0]}x{kept[1]}` keeps all"


def skipped_texts(skipped: Sequence[Skipped]) -> Iterator[str]:
    """Yield a line for each reason to skip pictures."""
    for reason in dict.fromkeys(each.reason for each in skipped):
        yield f"Skipped: {listed([each.name for each in skipped if each.reason == reason], MOST_LISTED)}: {reason}"


def _part_cut_off(source: tuple[int, int], target: tuple[int, int], is_scaled: bool) -> float:
    width, height = (have / want for have, want in zip(source, target, strict=True))
    kept = min(width, height) ** 2 if is_scaled else 1
    return 1 - kept / (width * height)
