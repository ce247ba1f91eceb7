"""T §6.6: the time of the shape detection grows linearly with the number of balls in the picture.

    python benchmarks/shape_balls.py                 with the fit of centre and radius
    python benchmarks/shape_balls.py --thesis        as in the thesis

Scenes with one to six balls side by side are rendered with mitsuba, and both cores of the simulated board look at them.
The last columns are the line through the times of a core by least squares, and the share of their variance that it
explains (R²).
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from statistics import correlation, linear_regression

from rich.console import Console
from rich.table import Table

from benchmarks.seen_circles import SHAPE_ROW, see
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.recording.scenes.drive import Pose
from bfsim.recording.scenes.objects import Ball
from bfsim.recording.scenes.scene import Scene
from bfsim.recording.scenes.studio import record_scene
from tinyphoon.scenes.soccer import FLOOR, SOCCER, YELLOW
from tinyphoon.stores.circles import CENTRE_PASSED, CIRCLE_TESTS, RADIUS_PASSED
from tinyphoon.strategy.modes import INDOOR_FIELD, PLAIN_CIRCLES

MOST_BALLS = 6
# Six of these stand side by side in both pictures, 17 px in radius and 14 px apart.
RADIUS_MM, DEPTH_MM, STEP_MM = 20.0, 450.0, 56.0
SAMPLES = 32


def scene_with(balls: int) -> Scene:
    """Return a row of equal balls across the middle of the picture, on an empty floor."""
    first_mm = STEP_MM * (balls - 1) / 2
    return replace(
        SOCCER,
        description=f"{balls} balls in a row",
        things={
            f"ball_{index}": Ball(
                x_mm=DEPTH_MM, y_mm=first_mm - STEP_MM * index, radius_mm=RADIUS_MM, colour=YELLOW
            )
            for index in range(balls)
        },
        floor=replace(FLOOR, size_mm=(4000.0, 4000.0), lines=()),
        poses=(Pose(x_mm=0, y_mm=0, heading_deg=0),),
        samples=SAMPLES,
        seed=606 + balls,
    )


def frames() -> Iterator[StereoFrame]:
    """Render a frame for each number of balls."""
    with tempfile.TemporaryDirectory() as folder:
        for balls in range(1, MOST_BALLS + 1):
            path = Path(folder) / f"{balls}.mcap"
            record_scene(scene_with(balls), path)
            with RecordingReader(path) as reader:
                (frame,) = reader.frames()
                yield replace(frame, index=balls - 1, left_ns=balls, right_ns=balls)


def table(*, thesis: bool) -> Table:
    """Return the times of both cores by the number of balls."""
    mode = replace(INDOOR_FIELD, circles=PLAIN_CIRCLES) if thesis else INDOOR_FIELD
    seen = see(frames(), mode)
    result = Table(
        title="Shape detection, ms by balls in the picture",
        title_justify="left",
        box=None,
        padding=(0, 1, 0, 0),
    )
    result.add_column("camera")
    for name in (*map(str, range(1, MOST_BALLS + 1)), "ms a ball", "ms at none", "R²"):
        result.add_column(name, justify="right")
    for side in ("left", "right"):
        own = [each for each in seen if each.side == side]
        times = [each.stages_ms[SHAPE_ROW] for each in own]
        balls = range(1, MOST_BALLS + 1)
        slope, none = linear_regression(balls, times)
        fitted = f"{slope:.3f}", f"{none:.3f}", f"{correlation(balls, times) ** 2:.4f}"
        result.add_row(side, *(f"{each:.2f}" for each in times), *fitted)
        passed = [int((each.words[:, CIRCLE_TESTS] == CENTRE_PASSED | RADIUS_PASSED).sum()) for each in own]
        result.add_row(" found", *map(str, passed), style="dim")
    return result


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--thesis", action="store_true", help="whole pixels, no fit")
    options = parser.parse_args()
    Console().print(table(thesis=options.thesis))


if __name__ == "__main__":
    main()
