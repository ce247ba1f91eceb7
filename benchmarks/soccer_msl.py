"""Real pictures of a soccer field: the share of balls that the firmware finds, and its false alarms in a frame.

`python -m benchmarks.soccer_msl FOLDER`: a folder of images with a .txt beside each, the boxes of YOLO ("class x y w h" as
shares of the picture; class 0 is the ball). They are made a recording by `record import`. The model of the ball gets the
colour and the size of the league's ball; its hall gets brighter thresholds of black and white, and nothing else is changed.
The cameras' geometry is not known but for the horizon, so that no size is expected of a blob where it is.

Area of interest, size, edge thresholds and the level of white were chosen among some thirty settings by every second
picture. The others are held out from that choice, but not unseen: the ball's hues and the horizon are from before, and
from all pictures.

The world is harder than the renderer: balls of a dozen pixels, over-exposed ones at the robot's foot, yellow wood, clothes
and walls.
"""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np
from PIL import Image
from rich.table import Table

from benchmarks.seen_objects import Records, Seen, see
from bfsim.process.terminal import print_report
from bfsim.report.tables.table import new_table
from tinyphoon.stages.blob_detection import hues
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.objects import (
    AREA_TEST,
    CENTRE_TEST,
    COLOUR_TEST,
    DIMENSION_TEST,
    OBJECT_IMAGE_X,
    OBJECT_IMAGE_Y,
    OBJECT_TESTS,
    SIZE_TEST,
)
from tinyphoon.strategy.models import MODELS, Shape, colour_groups
from tinyphoon.strategy.modes import INDOOR_FIELD, Mode

BALL_CLASS = "0"
BALL_MM = 220  # a football of size 5, the ball of RoboCup's middle-size league
BALL_HUES = hues(20, 23)  # yellow, as these cameras see it

FIELD_FROM = 0.54
"""The area of interest begins there, of the picture's height; above are the far end of the field, spectators, lamps."""

HORIZON = 0.47
"""Where these cameras have the horizon, by the far border of the field: what ends above it stands on no floor."""

FOCAL_SHARE = 0.66  # of the picture's width; of a fish-eye it means little
ANY_SIZE = 256  # to a factor of 16, the widest range that a mode may have

BOX_SLACK = 1.25
"""A centre in a box that is larger by this is on the ball."""

LEVELS = {
    "colour": COLOUR_TEST,
    "and dimension": DIMENSION_TEST,
    "and area": AREA_TEST,
    "and centre": CENTRE_TEST,
    "and radius": SIZE_TEST,
}

SIZE = (608, 368)
"""Of the recording: as wide as the pictures, and the area of interest as high."""

Box = tuple[float, float, float, float]
"""x and y of the middle, width and height, in pixels."""


@dataclass(slots=True)
class Count:
    """Balls found at a level, objects that are no ball, and of how many balls and frames."""

    found: int = 0
    false: int = 0


def hall_mode() -> Mode:
    """Return the indoor field's mode with the ball of the league and the light of its hall."""
    ball = next(each for each in MODELS if each.shape == Shape.BALL)
    models = (replace(ball, colours=BALL_HUES, width_mm=BALL_MM, height_mm=BALL_MM, depth_mm=BALL_MM),)
    return replace(
        INDOOR_FIELD,
        edges=replace(INDOOR_FIELD.edges, edge_threshold=12, strong_threshold=24, eps_black=0, eps_white=200),
        blobs=replace(INDOOR_FIELD.blobs, colour_groups=colour_groups(models)),
        objects=replace(INDOOR_FIELD.objects, size_range=ANY_SIZE),
        models=models,
    )


def geometry_of(width: int, height: int) -> tuple[float, float, float, float]:
    """Return focal length, a baseline and a height that mean nothing, and the tilt that puts the horizon where it is."""
    focal_px = FOCAL_SHARE * width
    above_px = height / 2 - (HORIZON - FIELD_FROM) / (1 - FIELD_FROM) * height
    return focal_px, 30.0, 1000.0, math.degrees(math.atan(above_px / focal_px))


def take_field(paths: Sequence[Path], folder: Path, size: tuple[int, int]) -> list[list[Box]]:
    """Put the area of interest of each picture into `folder`, scaled to `size`; returns the boxes of the balls whose middle is there."""
    boxes = []
    for path in paths:
        with Image.open(path) as picture:
            wide, high = picture.size
            top = round(FIELD_FROM * high)
            picture.crop((0, top, wide, high)).resize(size).save(folder / f"{path.stem}.png")
        scale_x, scale_y = size[0], size[1] / (1 - FIELD_FROM)
        boxes.append(
            [
                (x * scale_x, (y - FIELD_FROM) * scale_y, w * scale_x, h * scale_y)
                for x, y, w, h in balls_of(path)
                if y >= FIELD_FROM
            ]
        )
    return boxes


def see_balls(
    paths: Sequence[Path], folder: Path, size: tuple[int, int]
) -> tuple[list[Seen], list[list[Box]]]:
    """Return what the firmware sees in the area of interest of each picture, and the balls there; `folder` is for files."""
    recording = folder / "field.mcap"
    boxes = take_field(paths, folder, size)
    geometry = ["--geometry", *map(str, geometry_of(*size))]
    command = ["bfsim", "record", "import", str(recording), str(folder), "--mono", *geometry]
    subprocess.run([sys.executable, "-m", *command], check=True, stdout=subprocess.DEVNULL)
    return see(recording, hall_mode()), boxes


def balls_of(path: Path) -> list[Box]:
    """Return the boxes of the balls in a picture, as shares of it, from the annotation beside it."""
    rows = (line.split() for line in path.with_suffix(".txt").read_text().splitlines())
    balls = ([float(each) for each in row[1:]] for row in rows if row and row[0] == BALL_CLASS)
    return [(x, y, w, h) for x, y, w, h in balls]


def on_ball(records: Records, box: Box) -> Records:
    """Return which records have their middle in a box. What lies beyond the picture, of a ball that it cuts, is in no box."""
    x, y, width, height = box
    off_x = np.abs(np.clip(records[:, OBJECT_IMAGE_X] / SUBPIXELS, 0, SIZE[0] - 1) - x)
    off_y = np.abs(np.clip(records[:, OBJECT_IMAGE_Y] / SUBPIXELS, 0, SIZE[1] - 1) - y)
    return np.asarray((off_x <= BOX_SLACK * width / 2) & (off_y <= BOX_SLACK * height / 2))


def count(seen: Sequence[Seen], boxes: Sequence[Sequence[Box]]) -> dict[str, Count]:
    """Return what was found at each level, by the left camera alone: the right one has the same picture."""
    counts = {level: Count() for level in LEVELS}
    for each, balls in zip(seen, boxes, strict=True):
        for level, test in LEVELS.items():
            records = each.left[(each.left[:, OBJECT_TESTS] & test) != 0]
            hits = [on_ball(records, box) for box in balls]
            counts[level].found += sum(bool(hit.any()) for hit in hits)
            counts[level].false += int((~np.any(hits, axis=0)).sum()) if hits else len(records)
    return counts


def report(name: str, seen: Sequence[Seen], boxes: Sequence[Sequence[Box]]) -> Table:
    """Return the shares in some pictures."""
    balls, frames = sum(map(len, boxes)), len(boxes)
    table = new_table(
        f"{name}: {balls} balls in {frames} pictures",
        "Tests passed",
        "Balls found",
        "%",
        "False alarms a frame",
    )
    for level, each in count(seen, boxes).items():
        share = f"{100 * each.found / balls:.0f}" if balls else "-"
        table.add_row(level, f"{each.found}", share, f"{each.false / frames:.2f}")
    return table


@click.command()
@click.argument("folder", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option("--size", default="608x368", help="Size of the recording.", show_default=True)
def main(folder: Path, size: str) -> None:
    """Print how many balls of the pictures in FOLDER are found, and how much else."""
    width, height = (int(each) for each in size.split("x"))
    paths = sorted(each for each in folder.glob("*.jpg") if each.with_suffix(".txt").exists())
    with tempfile.TemporaryDirectory() as made:
        seen, boxes = see_balls(paths, Path(made), (width, height))
    for name, first in (("Thresholds chosen by them", 0), ("Held out", 1)):
        print_report(report(name, seen[first::2], boxes[first::2]))


if __name__ == "__main__":
    main()
