"""Features rectified in place of pictures (T §7.2): what it saves, and how far off edges, lines and depths are then.

`python -m benchmarks.rectified_features RECORDING...`: recordings of chessboards, whose corners OpenCV finds, with
rectification tables by `bfsim record calibrate`; with `--distort` and `--turn-right`, as for `bfsim record render`,
recordings rendered so, with tables that are exact but for whole pixels. Beside each other: pictures rectified, as
`tinyphoon` does, and features. Needs OpenCV (`pip install -e ".[opencv]"`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from benchmarks.playing import Played, play
from benchmarks.real.depth import FAR_PX, NEAR_PX, edge_points, errors_at, line_points
from benchmarks.rectified.cameras import RealCameras
from benchmarks.rectified.offsets import Offsets, rms
from benchmarks.rectified.truths import Points, Truth, truth_of
from benchmarks.scenes import TALLY_HEADS, compare, tally_cells
from bfsim.api import Seen
from bfsim.chip.boards import CM_BF561
from bfsim.errors import BfsimError
from bfsim.process.terminal import print_report
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.recording.scenes.lens import Lens, Misfit
from bfsim.report.tables.table import new_table, percent, stacked
from bfsim.running.inputs import calibration_of
from tinyphoon import rectified_features, tinyphoon

WAYS = {"pictures": tinyphoon, "features": rectified_features}
CCLK_PER_MS = CM_BF561.clocks.cclk_hz / 1000


@dataclass(frozen=True, slots=True)
class Way:
    """A recording seen with pictures or with features rectified, and what is known of each frame."""

    name: str
    played: Sequence[Played[Seen]]
    frames: Sequence[StereoFrame]
    truths: Sequence[Truth | None]


def seen_in(path: Path, limit: int | None, misfit: Misfit | None) -> list[Way]:
    """Play a recording both ways, with its own tables or the exact ones of cameras with a known misfit."""
    with RecordingReader(path) as reader:
        calibration, size = calibration_of(reader), (reader.height, reader.width)
        frames = list(reader.frames(limit))
    if misfit is not None:
        (geometry,) = calibration.geometries
        tables = RealCameras(geometry.focal_px, misfit.lens, misfit.turn_deg).tables(*size)
        calibration = replace(calibration, sources=dict(zip("AB", tables.values(), strict=True)))
    if not calibration.sources:
        raise click.ClickException(
            f"{path} must have rectification tables (bfsim record calibrate), or --distort must say its lens"
        )
    sources = dict(zip(("left", "right"), calibration.sources.values(), strict=True))
    truths = [truth_of(each, sources) for each in frames]
    ways = {name: each.calibrated(calibration) for name, each in WAYS.items()}
    return [Way(name, play(frames, each, each.view), frames, truths) for name, each in ways.items()]


def cost_cells(way: Way) -> list[str]:
    """Return ms a frame of both cores together, and of the rectification on each; the first frame waits for its picture."""
    later = way.played[1:]
    ends = [max(core.end_cclk - core.begin_cclk for core in each.record.cores) for each in later]
    parts = [
        np.mean([each.stages_cclk(core).get("Rectification", 0) for each in later]) for core in ("A", "B")
    ]
    edges = np.mean([len(each.taken["A"].edges) for each in later])
    return [f"{edges:.0f}", *(f"{each / CCLK_PER_MS:.2f}" for each in (np.mean(ends), *parts))]


def place_cells(way: Way) -> list[str]:
    """Return how far edges and lines are from the borders that they are of."""
    offsets = Offsets()
    for each, truth in zip(way.played, way.truths, strict=True):
        if truth is not None:
            offsets.add(each.taken["A"], truth)
    return [
        f"{len(offsets.edges)}", rms(offsets.edges), rms(offsets.means), percent(offsets.hit, offsets.steps),
        f"{len(offsets.lines) // 2}", rms(offsets.lines),
    ]  # fmt: skip


def depth_cells(way: Way) -> list[str]:
    """Return how far the disparities of 3-D edges and 3-D lines are from the true ones, and their depths."""
    cells = []
    for points_of in (edge_points, line_points):
        errors, disparities = _errors(way, points_of)
        near, far = (errors <= NEAR_PX).sum(), (errors > FAR_PX).sum()
        off_px, off_percent = (
            f"{np.median(each):.2f}" if len(each) else "-" for each in (errors, 100 * errors / disparities)
        )
        cells += [
            f"{len(errors)}",
            off_px,
            off_percent,
            percent(near, len(errors)),
            percent(far, len(errors)),
        ]
    return cells


def _errors(way: Way, points_of: Callable[[Seen], Points]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the errors of disparities and the disparities, of all points whose true disparity is known."""
    errors, disparities = [np.empty(0)], [np.empty(0)]
    for each, truth in zip(way.played, way.truths, strict=True):
        if truth is not None:
            points = points_of(each.taken["A"])
            off = errors_at(points, truth.disparities, truth.reach)
            errors.append(off[~np.isnan(off)])
            disparities.append(points[~np.isnan(off), 2])
    return np.concatenate(errors), np.concatenate(disparities)


def object_rows(way: Way) -> list[list[str]]:
    """Return what is found of each thing that there is a model for, and how far off."""
    frames = zip(way.played, way.frames, strict=True)
    tallies, _ = compare((each.taken["A"], frame.truth) for each, frame in frames if frame.truth)
    return [[name, *tally_cells(tally)] for name, tally in tallies.items()]


def comparison(recordings: Sequence[Path], limit: int | None, misfit: Misfit | None) -> list[Table]:
    """Return the tables."""
    cost = new_table("What it costs: ms a frame", "Recording", "rectified", "edges", "frame", "A", "B")
    cost.caption = (
        "Edges of the left picture; A, B: the rectification on each core. The first frame is left out."
    )
    columns = "edges", "off, px", "mean off", "found %", "lines", "off, px"
    place = new_table(
        "Edges and lines beside straight borders, left picture", "Recording", "rectified", *columns
    )
    place.caption = "Off: RMS across the border; mean off: of the mean of each border's edges; found: rows or columns of borders with an edge."
    errors = "off, px", "off, %", "1 px %", "5 px %"
    columns = "3-D edges", *errors, "in lines", *errors
    depth = new_table("Disparities beside the true ones", "Recording", "rectified", *columns)
    depth.caption = (
        "Those whose true disparity is known. Off: median, of disparities and of depths; 1 px: at most so far off; "
        "5 px: farther; of 3-D lines points along them."
    )
    objects = new_table(
        "Things found, and the mean error of those found", "Recording", "rectified", "thing", *TALLY_HEADS
    )
    for path in recordings:
        for way in seen_in(path, limit, misfit):
            for table, cells in ((cost, cost_cells), (place, place_cells), (depth, depth_cells)):
                table.add_row(path.stem, way.name, *cells(way))
            for cells in object_rows(way):
                objects.add_row(path.stem, way.name, *cells)
    return [cost, place, depth, *([objects] if objects.rows else [])]


@click.command()
@click.argument("recordings", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--frames", metavar="N", type=click.IntRange(min=2), help="Only the first N frames of each.")
@click.option("--distort", metavar="K1 K2 P1 P2", type=float, nargs=4, help="Exact tables of this lens.")
@click.option("--turn-right", metavar="X Y Z", type=float, nargs=3, default=(0, 0, 0))
def main(
    recordings: tuple[Path, ...],
    frames: int | None,
    distort: tuple[float, float, float, float] | None,
    turn_right: tuple[float, float, float],
) -> None:
    """Compare rectified features with rectified pictures on RECORDINGS."""
    misfit = Misfit(Lens(*distort), turn_right) if distort else None
    try:
        print_report(stacked(*comparison(recordings, frames, misfit)))
    except BfsimError as error:
        raise click.ClickException(str(error)) from None


if __name__ == "__main__":
    main()
