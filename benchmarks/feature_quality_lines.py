"""Lines of the firmware beside OpenCV's line segment detector (LSD), on the pictures of recordings.

`python benchmarks/feature_quality_lines.py [RECORDING]... [--frames N]` needs OpenCV (`pip install -e ".[opencv]"`).
A line has a partner if lines of the other kind cover half of it, within 2 pixels and 5 degrees. Directions are
told apart only modulo half a turn. Edges that the edge store had no room for, at the bottom of a cluttered
picture, are no lines of ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from benchmarks.seen_lines import Lines, Picture, see
from benchmarks.table_6_1 import lsd_lines
from bfsim.chip.boards import CM_BF561
from bfsim.errors import BfsimError
from bfsim.recording import RecordingReader
from bfsim.report.tables import new_table, percent
from bfsim.run import BUILT_IN_RECORDING
from bfsim.terminal import print_report

NEAR_PX = 2.0
NEAR_DEGREES = 5.0
LONG_PX = (20.0, 40.0)
"""From these lengths on a line of LSD is long, each limit a column of its own."""


def lengths(lines: Lines) -> NDArray[np.float64]:
    """Return the lengths of lines in pixels."""
    return np.hypot(lines[:, 2] - lines[:, 0], lines[:, 3] - lines[:, 1])


def has_partner(lines: Lines, others: Lines) -> NDArray[np.bool_]:
    """Say of each line whether `others` cover half of it: points a pixel apart are asked one by one."""
    turns = np.arctan2(others[:, 3] - others[:, 1], others[:, 2] - others[:, 0])
    steps = np.maximum(lengths(others), 1e-9)
    along = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    covered = np.zeros(len(lines), bool)
    for number, (line, length) in enumerate(zip(lines, lengths(lines), strict=True)):
        turn = np.arctan2(line[3] - line[1], line[2] - line[0]) - turns
        parallel = abs(np.sin(turn)) <= np.sin(np.radians(NEAR_DEGREES))
        points = np.linspace(line[:2], line[2:], max(round(length), 2))
        off = points[:, None] - others[None, parallel, :2]
        foot = np.clip((off * along[parallel]).sum(axis=2), 0, steps[parallel])
        distance = np.linalg.norm(off - foot[:, :, None] * along[parallel], axis=2)
        covered[number] = (distance <= NEAR_PX).any(axis=1).mean() >= 0.5
    return covered


def pictures_of(recording: Path, frames: int | None) -> list[Picture]:
    """Return the luma of both cameras' pictures, left and right in turn."""
    with RecordingReader(recording) as reader:
        pairs = reader.frames(min(frames or reader.frame_count, reader.frame_count))
        return [np.ascontiguousarray(each[:, 1::2]) for pair in pairs for each in (pair.left, pair.right)]


def comparison(recordings: Sequence[Path], frames: int | None) -> Table:
    """Return a row of numbers for each recording."""
    long = [f"LSD from {limit:.0f} px: found, %" for limit in LONG_PX]
    ours = "Ours", "Ours, px", "Without LSD partner, %"
    table = new_table("Lines beside LSD", "Recording", "Pictures", "Edges lost, %", *long, *ours, "Median ms")
    for recording in recordings:
        pictures = pictures_of(recording, frames)
        table.add_row(recording.stem, f"{len(pictures)}", *quality(pictures))
    return table


def quality(pictures: Sequence[Picture]) -> list[str]:
    """Return the numbers of the pictures of one recording, from the edges lost on."""
    seen = see(pictures)
    pairs = [(each.lines, lsd_lines(picture)) for each, picture in zip(seen, pictures, strict=True)]
    found = np.concatenate([has_partner(lsd, own) for own, lsd in pairs])
    lsd_px = np.concatenate([lengths(lsd) for _, lsd in pairs])
    partner = np.concatenate([has_partner(own, lsd) for own, lsd in pairs])
    own_px = np.concatenate([lengths(own) for own, _ in pairs])
    stored, lost = (sum(each.results[name] for each in seen) for name in ("edges", "edges_lost"))
    cclk = np.median([each.stages_cclk["Line detection"] for each in seen])
    return [
        percent(lost, stored + lost),
        *(_share(found[lsd_px >= limit]) for limit in LONG_PX),
        f"{len(own_px)}",
        f"{own_px.sum():.0f}",
        percent(own_px[~partner].sum(), own_px.sum()),
        f"{1000 * cclk / CM_BF561.clocks.cclk_hz:.2f}",
    ]


def _share(found: NDArray[np.bool_]) -> str:
    return f"{found.sum()} of {len(found)}, {percent(found.sum(), len(found))}"


@click.command()
@click.argument("recordings", nargs=-1, type=click.Path(path_type=Path))
@click.option("--frames", metavar="N", type=click.IntRange(min=1), help="Stop after N frames of each.")
def main(recordings: tuple[Path, ...], frames: int | None) -> None:
    """Compare the lines found in RECORDINGS, or in the built-in one, with LSD's."""
    try:
        print_report(comparison(recordings or (BUILT_IN_RECORDING,), frames))
    except BfsimError as error:
        raise click.ClickException(str(error)) from None


if __name__ == "__main__":
    main()
