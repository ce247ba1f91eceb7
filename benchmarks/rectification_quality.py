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
from benchmarks.rectified.cameras import RealCameras
from bfsim.api import Calibration
from bfsim.errors import BfsimError
from bfsim.process.terminal import print_report
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.recording.scenes.lens import Lens
from bfsim.report.tables.table import new_table, percent
from bfsim.shipped import RECORDING
from tinyphoon import tinyphoon

CAMERAS = RealCameras(386.0, Lens(-0.25, 0.08), (1.0, -1.0, 0.5))  # T §6.2: the focal length


def psnr(one: Picture, other: Picture, counted: NDArray[np.bool_]) -> str:
    """Return mean absolute difference in grey levels and peak signal-to-noise ratio in dB."""
    off = one[counted].astype(float) - other[counted]
    return f"{np.abs(off).mean():.2f} {10 * np.log10(255**2 / max((off**2).mean(), 1e-9)):.1f}"


def compare(path: Path, limit: int) -> list[tuple[str, ...]]:
    """Return the cells of each camera of a recording."""
    with RecordingReader(path) as reader:
        height, width = reader.height, reader.width
        pairs = list(reader.frames(min(limit, reader.frame_count)))
    points = {side: CAMERAS.sources(height, width, side) for side in ("left", "right")}
    tables = dict(zip("AB", CAMERAS.tables(height, width).values(), strict=True))
    back = {side: CAMERAS.targets(height, width, side) for side in points}
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
        print_report(comparison(recordings or (RECORDING,), frames))
    except BfsimError as error:
        raise click.ClickException(str(error)) from None


if __name__ == "__main__":
    main()
