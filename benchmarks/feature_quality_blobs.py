"""The blobs of the firmware beside OpenCV's connected components, on the same opened colour images.

    python benchmarks/feature_quality_blobs.py                          the built-in recording
    python benchmarks/feature_quality_blobs.py drive.mcap --frames 10

The firmware runs on the simulated machine, a board for each frame; both images and blobs are then read from its
memories. For each colour group, `connectedComponentsWithStats` with 8 neighbours gives the components, and the
thresholds of the firmware leave those of the right size. The columns behind count the blobs that OpenCV has too,
with the same rectangle, the same number of pixels as well, and the same centre of mass as well, unrounded. Needs
opencv-python-headless.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from bfsim.chip.boards import CM_BF561
from bfsim.linker import link, parse_ldf
from bfsim.machine.board import Board, symbols_of
from bfsim.machine.program import FrameSize
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.run import BUILT_IN_RECORDING, THESIS_LDF
from firmware import tinyphoon
from firmware.blob_store import ACROSS, BLOB_WORDS, COLOURS, DOWN, PIXELS, SUM_X, SUM_Y
from firmware.modes import INDOOR_FIELD

CAMERAS = {"A": "left", "B": "right"}
COLUMNS = ("blobs", "OpenCV", "rectangle", "pixels", "centre", "lost", "runs lost")


@dataclass(frozen=True, slots=True)
class Region:
    """A blob of ours or a component of OpenCV's; the rectangle is left, top, width and height."""

    rectangle: tuple[int, int, int, int]
    pixels: int
    centre: tuple[float, float]


def ours(board: Board, core: str, count: int) -> Iterator[tuple[int, Region]]:
    """Yield the colours and the region of each blob that a core left in its store."""
    for record in board.cores[core].array("blob_data").array.reshape(-1, BLOB_WORDS)[:count].tolist():
        (left, right), (top, bottom) = (
            (record[word] & 0xFFFF, record[word] >> 16) for word in (ACROSS, DOWN)
        )
        rectangle = left, top, right - left + 1, bottom - top + 1
        centre = record[SUM_X] / record[PIXELS], record[SUM_Y] / record[PIXELS]
        yield record[COLOURS], Region(rectangle, record[PIXELS], centre)


def theirs(opened: NDArray[Any], colours: int) -> Iterator[Region]:
    """Yield OpenCV's components of a group of colours that have the size of a blob."""
    mask = (opened & colours != 0).astype(np.uint8)
    _, _, stats, centres = cv2.connectedComponentsWithStats(mask, connectivity=8)
    for (left, top, width, height, pixels), (x, y) in zip(
        stats[1:].tolist(), centres[1:].tolist(), strict=True
    ):
        if INDOOR_FIELD.blobs.min_pixels <= pixels <= INDOOR_FIELD.blobs.max_pixels:
            yield Region((left, top, width, height), pixels, (x, y))


def compare(found: Sequence[Region], reference: Sequence[Region]) -> Counter[str]:
    """Count the regions of both, and those of ours that the reference has as well, ever more exactly."""
    rectangles = {each.rectangle for each in reference}
    sized = {(each.rectangle, each.pixels) for each in reference}
    return Counter(
        {
            "blobs": len(found),
            "OpenCV": len(reference),
            "rectangle": sum(each.rectangle in rectangles for each in found),
            "pixels": sum((each.rectangle, each.pixels) in sized for each in found),
            "centre": sum(each in reference for each in found),
        }
    )


def compare_frame(frame: StereoFrame) -> Iterator[tuple[str, str, Counter[str]]]:
    """Yield camera, colours and comparison of one stereo frame. Losses are no colour's: they go under "all"."""
    height, double_width = frame.left.shape
    size = FrameSize(double_width // 2, height)
    link_map = link(parse_ldf(THESIS_LDF), symbols_of(tinyphoon, size), CM_BF561.chip.regions)
    board = Board(CM_BF561, tinyphoon, size, link_map)
    (record,) = board.run(iter([replace(frame, index=0)])).frames
    for core, camera in CAMERAS.items():
        blobs = list(ours(board, core, record.results[f"blobs_{core}"]))
        opened = np.array([row.array for row in board.cores[core].rows("opened_image")])
        for colours in INDOOR_FIELD.blobs.colour_groups:
            found = [region for group, region in blobs if group == colours]
            yield camera, f"0x{colours:08X}", compare(found, list(theirs(opened, colours)))
        lost = {
            "lost": record.results[f"blobs_lost_{core}"],
            "runs lost": record.results[f"labels_lost_{core}"],
        }
        yield camera, "all", Counter(lost)


def compare_recording(path: Path, limit: int | None) -> dict[tuple[str, str], Counter[str]]:
    """Add up the comparisons of a recording's frames by camera and colours; "all" has the sums of its camera."""
    sums: dict[tuple[str, str], Counter[str]] = {}
    with RecordingReader(path) as reader:
        for frame in reader.frames(limit):
            for camera, colours, counts in compare_frame(frame):
                for key in {colours, "all"}:
                    sums.setdefault((camera, key), Counter()).update(counts)
    return sums


def table(path: Path, limit: int | None) -> Table:
    """Return the comparison of a recording."""
    result = Table(
        title=f"{path.name}: blobs and OpenCV's components",
        title_justify="left",
        box=None,
        padding=(0, 1, 0, 0),
    )
    for name in ("camera", "colours"):
        result.add_column(name)
    for name in COLUMNS:
        result.add_column(name, justify="right")
    for (camera, colours), counts in sorted(compare_recording(path, limit).items()):
        last = colours == "all"
        numbers = (f"{counts[name]:,}" if last or name in counts else "" for name in COLUMNS)
        result.add_row(camera, colours, *numbers, end_section=last, style="bold" if last else "")
    return result


def main() -> None:
    """Print the comparison."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("recordings", nargs="*", type=Path, default=[BUILT_IN_RECORDING], help="MCAP files")
    parser.add_argument("--frames", type=int, help="only the first stereo frames of each")
    options = parser.parse_args()
    console = Console()
    for path in options.recordings:
        console.print(table(path, options.frames))


if __name__ == "__main__":
    main()
