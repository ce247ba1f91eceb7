"""The firmware's edges beside those of OpenCV: `cv2.Canny` with like parameters on the same pictures.

`python benchmarks/feature_quality_edges.py [RECORDING ...] [--frames N] [--gauss 3|5]` plays recordings (the built-in
one without a name) through the simulated board, reads the edge images out of its memory, and prints one table.

Like parameters: the binomial Gauss of the same size, Sobel 3x3, the length of the gradient (L2), and both thresholds
times four, since the firmware stores quarters of a gradient. Precision is the share of our edge pixels that have one of
OpenCV's within 1 px (8-neighbourhood), recall the share of OpenCV's that have one of ours; `same` is the share of both
together that is the same pixel. OpenCV comes with the extra `quality`.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import click
import cv2
import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from bfsim.api import Core, Firmware
from bfsim.chip.boards import CM_BF561
from bfsim.errors import BfsimError
from bfsim.linker import link, parse_ldf
from bfsim.machine.board import Board, symbols_of
from bfsim.machine.program import FrameSize
from bfsim.recording import RecordingReader
from bfsim.report.tables import new_table, percent
from bfsim.run import BUILT_IN_RECORDING, THESIS_LDF, calibration_of
from bfsim.terminal import print_report, progress_bar
from firmware import tinyphoon
from firmware.modes import INDOOR_FIELD
from firmware.stages.edge_detection import EdgeThresholds, edge_detection
from firmware.stages.rectification import rectification

GRADIENT_UNIT = 4  # Sobel units in one of the firmware
NEAR = np.ones((3, 3), np.uint8)

Picture = NDArray[np.uint8]


@dataclass(slots=True)
class Agreement:
    """Edge pixels of both, and how many have one of the other's at the same place or within 1 px."""

    frames: int = 0
    ours: int = 0
    theirs: int = 0
    same: int = 0
    ours_near: int = 0
    theirs_near: int = 0
    lost: int = 0

    def add(self, ours: Picture, theirs: Picture, lost: int) -> None:
        """Count one picture's edges, given as pictures of 0 and 1; `lost` are ours without room in the edge store."""
        self.frames += 1
        self.ours += int(ours.sum())
        self.theirs += int(theirs.sum())
        self.same += int((ours & theirs).sum())
        self.ours_near += int((ours & cv2.dilate(theirs, NEAR)).sum())
        self.theirs_near += int((theirs & cv2.dilate(ours, NEAR)).sum())
        self.lost += lost


def opencv_edges(uyvy: Picture, thresholds: EdgeThresholds) -> Picture:
    """Return OpenCV's edges of a picture as 0 and 1."""
    luma = np.ascontiguousarray(uyvy[:, 1::2])
    smooth = cv2.GaussianBlur(
        luma, (thresholds.gauss_px, thresholds.gauss_px), 0, borderType=cv2.BORDER_REPLICATE
    )
    low, high = GRADIENT_UNIT * thresholds.edge_threshold, GRADIENT_UNIT * thresholds.strong_threshold
    return cv2.Canny(smooth, low, high, L2gradient=True) & 1


def edges_only(thresholds: EdgeThresholds) -> Firmware:
    """Return the firmware with nothing but its edge detection, at those thresholds."""

    def main(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            with core.stage("Edge detection"):
                frame = yield from rectification(core, frame)
                yield from edge_detection(core, frame, thresholds)

    return replace(tinyphoon, mains={"A": main, "B": main})


def compare(path: Path, limit: int, thresholds: EdgeThresholds) -> dict[str, Agreement]:
    """Play up to `limit` frames of a recording; return how far both cameras' edges agree."""
    found = {"left": Agreement(), "right": Agreement()}
    with RecordingReader(path) as reader, progress_bar(f"Simulating {path.name}") as progress:
        size, total = FrameSize(reader.width, reader.height), min(limit, reader.frame_count)
        firmware = edges_only(thresholds).calibrated(calibration_of(reader))
        places = link(parse_ldf(THESIS_LDF), symbols_of(firmware, size), CM_BF561.chip.regions)
        for done, frame in enumerate(reader.frames(total)):
            board = Board(CM_BF561, firmware, size, places)
            outcome = board.run(iter([replace(frame, index=0)]))
            results = outcome.frames[0].results
            for core, side, uyvy in (("A", "left", frame.left), ("B", "right", frame.right)):
                seen = picture_of(board.cores[core], "rectified_image", uyvy)
                ours = (picture_of(board.cores[core], "edge_image", uyvy) > 0).astype(np.uint8)
                found[side].add(ours, opencv_edges(seen, thresholds), results[f"edges_lost_{core}"])
            progress(done + 1, total)
    return found


def picture_of(core: Core, name: str, otherwise: Picture) -> Picture:
    """Return what is in a buffer of a core, if it has it."""
    if not core.has_buffer(name):
        return otherwise
    return np.array([row.array for row in core.rows(name)])


def rows_of(found: Sequence[tuple[str, dict[str, Agreement]]]) -> Iterator[tuple[str, ...]]:
    """Yield the cells of each recording and camera."""
    for name, cameras in found:
        for side, each in cameras.items():
            yield (
                name if side == "left" else "",
                side,
                str(each.frames),
                f"{each.ours / each.frames:,.0f}",
                f"{each.theirs / each.frames:,.0f}",
                percent(each.ours_near, each.ours),
                percent(each.theirs_near, each.theirs),
                percent(each.same, each.ours + each.theirs - each.same),
                f"{each.lost / each.frames:,.0f}",
            )


def comparison(found: Sequence[tuple[str, dict[str, Agreement]]], thresholds: EdgeThresholds) -> Table:
    """Return the agreement as a table."""
    limits = f"thresholds {thresholds.edge_threshold} and {thresholds.strong_threshold}"
    table = new_table(
        f"Edges beside cv2.Canny {cv2.__version__}, Gauss {thresholds.gauss_px}x{thresholds.gauss_px}, {limits}",
        "Recording",
        *("camera", "frames", "ours", "OpenCV", "precision %", "recall %", "same %", "lost"),
    )
    table.caption = "Edge pixels per frame; lost: ours that had no room in the edge store."
    table.caption_justify = "left"
    for cells in rows_of(found):
        table.add_row(*cells)
    return table


@click.command()
@click.argument("recordings", nargs=-1, type=click.Path(path_type=Path))
@click.option("--frames", default=10, show_default=True, help="At most so many frames of each recording.")
@click.option(
    "--gauss", type=click.Choice(["3", "5"]), default="3", show_default=True, help="Size in pixels."
)
def main(recordings: tuple[Path, ...], frames: int, gauss: str) -> None:
    """Compare the edges of RECORDINGS, or of the built-in one, with OpenCV's."""
    thresholds = replace(INDOOR_FIELD.edges, gauss_px=5 if gauss == "5" else 3)
    try:
        found = [
            (path.stem, compare(path, frames, thresholds)) for path in recordings or (BUILT_IN_RECORDING,)
        ]
    except BfsimError as error:
        raise click.ClickException(str(error)) from None
    print_report(comparison(found, thresholds))


if __name__ == "__main__":
    main()
