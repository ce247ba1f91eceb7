"""How well the firmware measures balls in any light: centre and radius of drawn balls, condition by condition.

`python -m benchmarks.ball_radii [--frames 4]`: each row of the table is a condition, of light, floor, lens and noise
(`benchmarks/drawn/balls.py` draws them), with twelve balls a frame of 4 to 40 px in radius. All stages run on the
simulated board. *Found* are those whose circle passes both tests; *bias* is the mean error and *spread* its standard
deviation, *centre* how far the middle is off in the mean, all in px. The columns behind are the bias by radius.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import click
import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from benchmarks.drawn.balls import BETWEEN_HUES, BRIGHT_FLOOR, DARK_BALL, MIDDLE_FLOOR, Condition, frame_of
from benchmarks.seen_circles import see
from bfsim.process.terminal import print_report, progress_bar
from bfsim.report.tables.table import new_table
from tinyphoon.stores.circles import CIRCLE_EDGES, CIRCLE_RADIUS, CIRCLE_TESTS, CIRCLE_X, RADIUS_PASSED
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.strategy.modes import INDOOR_FIELD

RADII_PX = (4, 7, 12, 20, 40)

BRIGHT = Condition("bright ball")
DARK = Condition("dark ball", ball=DARK_BALL, floor=BRIGHT_FLOOR)
ABOVE = (0.0, -0.8, 0.6)
BESIDE = (0.8, -0.3, 0.5)


def _kinds(base: Condition) -> list[Condition]:
    """Return a ball in all sorts of light."""
    changes: dict[str, dict[str, object]] = {
        "": {},
        "sharp": {"blur": 0.0},
        "blur 1.5": {"blur": 1.5},
        "blur 2.5": {"blur": 2.5},
        "textured": {"texture": 10.0},
        "noisy": {"noise": 4.0},
        "lit from above": {"sun": ABOVE, "ambient": 0.4},
        "lit from beside": {"sun": BESIDE, "ambient": 0.4},
        "shadow": {"sun": ABOVE, "ambient": 0.5, "shadow": 0.5},
        "all of it": {
            "sun": BESIDE, "ambient": 0.4, "shadow": 0.5, "texture": 8.0, "blur": 1.5, "noise": 2.5,
        },
    }  # fmt: skip
    return [replace(base, name=f"{base.name} {name}".strip(), **change) for name, change in changes.items()]  # type: ignore[arg-type]


CONDITIONS = [
    *_kinds(BRIGHT),
    *_kinds(DARK),
    Condition("half brighter, half darker", floor=MIDDLE_FLOOR, sun=BESIDE, ambient=0.3),
    Condition("so, with shadow, blur 1.5", floor=MIDDLE_FLOOR, sun=BESIDE, ambient=0.3, shadow=0.5, blur=1.5),
    Condition("ambient of a tenth", sun=BESIDE, ambient=0.1),
    Condition("between two hues, noisy", ball=BETWEEN_HUES, noise=4.0),
]


@dataclass(frozen=True, slots=True)
class Errors:
    """Of the balls of a condition: true radii, and how far x, y and radius are off, a row each; NaN if it is not found."""

    radii: NDArray[np.float64]
    off: NDArray[np.float64]

    @property
    def found(self) -> NDArray[np.bool_]:
        """Which of them are found."""
        return np.isfinite(self.off[:, 0])


def errors_of(
    condition: Condition, frames: int, radii_px: tuple[float, float] = (RADII_PX[0], RADII_PX[-1])
) -> Errors:
    """Draw balls and see them."""
    shots = [frame_of(condition, *radii_px, number) for number in range(frames)]
    radii, off = [], []
    for seen in see(shots, INDOOR_FIELD):
        passed = seen.words[seen.words[:, CIRCLE_TESTS] & RADIUS_PASSED != 0]
        circles = passed[:, CIRCLE_X : CIRCLE_RADIUS + 1] / SUBPIXELS
        for ball in (seen.frame.truth or {})[seen.side]:
            radii.append(ball[2])
            wrong = circles - ball
            near = np.hypot(wrong[:, 0], wrong[:, 1]) <= max(ball[2] / 2, 2)
            most = np.where(near, passed[:, CIRCLE_EDGES], 0)
            off.append(wrong[most.argmax()] if near.any() else np.full(3, np.nan))
    return Errors(np.array(radii), np.array(off))


def row_of(errors: Errors) -> list[str]:
    """Return the cells of a condition."""
    off, radii = errors.off[errors.found], errors.radii[errors.found]
    cells = [f"{len(off)} of {len(errors.off)}"]
    if not len(off):
        return cells
    cells += [
        f"{off[:, 2].mean():+.2f}",
        f"{off[:, 2].std():.2f}",
        f"{np.hypot(off[:, 0], off[:, 1]).mean():.2f}",
    ]
    for least, most in itertools.pairwise(RADII_PX):
        band = off[(radii >= least) & (radii < most), 2]
        cells.append(f"{band.mean():+.2f}" if len(band) else "-")
    return cells


def table(conditions: Sequence[Condition], frames: int) -> Table:
    """Return a row a condition."""
    bands = [f"{least} to {most}" for least, most in itertools.pairwise(RADII_PX)]
    result = new_table(
        "Drawn balls: errors of radius and centre in px", "Light", "found", "bias", "spread", "centre", *bands
    )
    with progress_bar("Simulating") as progress:
        for number, each in enumerate(conditions):
            result.add_row(each.name, *row_of(errors_of(each, frames)))
            progress(number + 1, len(conditions))
    return result


@click.command()
@click.option("--frames", default=4, show_default=True, help="Frames a condition, with twelve balls each.")
def main(frames: int) -> None:
    """Print how well balls are measured."""
    print_report(table(CONDITIONS, frames))


if __name__ == "__main__":
    main()
