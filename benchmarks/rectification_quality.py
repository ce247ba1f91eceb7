"""One look-up table beside four weighted ones (T §5.2.5): how well rectification brings pictures back.

`python benchmarks/rectification_quality.py [RECORDING]... [--frames N]` bends the luma of rectified pictures as the
cameras of README.md's example do, has the firmware rectify them on the simulated board with one table a camera, and
compares with the pictures from before. The reference is rectification with four tables and four weights (bilinear), in
floats. Pixels without a source are left out. Bending costs sharpness, too (Lanczos, 8x8). Needs OpenCV (`pip install -e
".[opencv]"`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click
import cv2
import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from benchmarks.quality.seen import Picture, see, uyvy
from bfsim.api import Calibration, SourcePixels
from bfsim.errors import BfsimError
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.recording.scenes.lens import Lens, turned
from bfsim.report.tables import new_table, percent
from bfsim.run import BUILT_IN_RECORDING
from bfsim.terminal import print_report
from tinyphoon import tinyphoon

FOCAL_PX = 386.0  # T §6.2
LENS = Lens(-0.25, 0.08)
RIGHT_TURN_DEG = (1.0, -1.0, 0.5)

Points = NDArray[np.float32]
"""Columns and rows of shape (height, width, 2)."""


def camera_turn(side: str) -> NDArray[np.float64]:
    """Return the rotation of a camera against the rectified one."""
    rotation = np.eye(3)
    if side == "right":
        for axis, angle_deg in enumerate(RIGHT_TURN_DEG):
            rotation = turned(rotation, axis, angle_deg)
    return rotation


def rays(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points at unit depth as vectors."""
    return np.concatenate([points, np.ones_like(points[..., :1])], axis=-1)


def pixels_of(height: int, width: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the pixels of a picture as points at unit depth, and its centre."""
    centre = np.array([width - 1, height - 1]) / 2
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    return (np.stack([columns, rows], axis=-1) - centre) / FOCAL_PX, centre


def sources(height: int, width: int, side: str) -> Points:
    """Return where each rectified pixel lies in the picture of a camera."""
    points, centre = pixels_of(height, width)
    seen = rays(points) @ camera_turn(side).T
    return (LENS.distort(seen[..., :2] / seen[..., 2:]) * FOCAL_PX + centre).astype(np.float32)


def targets(height: int, width: int, side: str) -> Points:
    """Return where each pixel of a camera lies in the rectified picture."""
    points, centre = pixels_of(height, width)
    ideal = rays(LENS.undistort(points)) @ camera_turn(side)
    return (ideal[..., :2] / ideal[..., 2:] * FOCAL_PX + centre).astype(np.float32)


def nearest(points: Points) -> SourcePixels:
    """Return one table: the nearest pixels, -1 outside of the picture."""
    columns, rows = np.moveaxis(np.rint(points).astype(np.int32), -1, 0)
    height, width = rows.shape
    inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    return SourcePixels(np.where(inside, rows, np.int32(-1)), np.where(inside, columns, np.int32(-1)))


def psnr(one: Picture, other: Picture, counted: NDArray[np.bool_]) -> str:
    """Return mean absolute difference in grey levels and peak signal-to-noise ratio in dB."""
    off = one[counted].astype(float) - other[counted]
    return f"{np.abs(off).mean():.2f} {10 * np.log10(255**2 / max((off**2).mean(), 1e-9)):.1f}"


def compare(path: Path, limit: int) -> list[tuple[str, ...]]:
    """Return the cells of each camera of a recording."""
    with RecordingReader(path) as reader:
        height, width = reader.height, reader.width
        pairs = list(reader.frames(min(limit, reader.frame_count)))
    points = {side: sources(height, width, side) for side in ("left", "right")}
    tables = {core: nearest(points[side]) for core, side in (("A", "left"), ("B", "right"))}
    back = {side: targets(height, width, side) for side in points}
    luma = {side: [np.ascontiguousarray(getattr(pair, side)[:, 1::2]) for pair in pairs] for side in points}
    bent = {
        side: [cv2.remap(each, back[side], None, cv2.INTER_LANCZOS4) for each in luma[side]]
        for side in points
    }
    frames: Sequence[StereoFrame] = [
        replace(pair, left=uyvy(left), right=uyvy(right))
        for pair, left, right in zip(pairs, bent["left"], bent["right"], strict=True)
    ]
    seen = see(frames, tinyphoon.calibrated(Calibration(sources=tables)))
    rows = []
    for number, (side, core) in enumerate((("left", "A"), ("right", "B"))):
        # a pixel at the border of the bent picture may have come from outside of the straight one
        came = cv2.remap(np.ones((height, width), np.uint8), back[side], None, cv2.INTER_NEAREST)
        counted = (tables[core].rows >= 0) & (
            cv2.erode(cv2.remap(came, points[side], None, cv2.INTER_NEAREST), np.ones((9, 9), np.uint8)) > 0
        )
        one = np.array([each.luma for each in seen[number::2]])
        four = np.array([cv2.remap(each, points[side], None, cv2.INTER_LINEAR) for each in bent[side]])
        every = np.broadcast_to(counted, one.shape)
        before = np.array(luma[side])
        rows.append(
            (
                side,
                percent((tables[core].rows >= 0).sum(), height * width),
                psnr(one, before, every),
                psnr(four, before, every),
                psnr(one, four, every),
            )
        )
    return rows


def comparison(recordings: Sequence[Path], limit: int) -> Table:
    """Return a row of numbers for each camera of each recording."""
    table = new_table(
        "Rectification: mean absolute difference in grey levels, PSNR in dB",
        "Recording",
        *("camera", "pixels %", "one table", "four tables", "one from four"),
    )
    for path in recordings:
        for cells in compare(path, limit):
            table.add_row(path.stem, *cells)
    return table


@click.command()
@click.argument("recordings", nargs=-1, type=click.Path(path_type=Path))
@click.option("--frames", metavar="N", type=click.IntRange(min=1), default=10, show_default=True)
def main(recordings: tuple[Path, ...], frames: int) -> None:
    """Compare rectification by one table with that by four on RECORDINGS, or on the built-in one."""
    try:
        print_report(comparison(recordings or (BUILT_IN_RECORDING,), frames))
    except BfsimError as error:
        raise click.ClickException(str(error)) from None


if __name__ == "__main__":
    main()
