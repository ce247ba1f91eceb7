"""T Figure 6.4: distance against disparity, and what one pixel too many or too few does to it.

`python -m benchmarks.figure_6_4 --picture FILE.png` (or .svg) draws it; without, it prints some of the numbers. They are made
by the kernel that gives the firmware's 3-D lines their depth.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np
from rich.table import Table

from bfsim.errors import BfsimError
from bfsim.process.terminal import print_report
from bfsim.recording import StereoGeometry
from bfsim.report.ldf.picture import format_of
from bfsim.report.ldf.sheet import FAINT, INK, FilledBox, Sheet, Words
from bfsim.report.tables.table import new_table
from tinyphoon.geometry import depth_mm, geometry_buffer
from tinyphoon.stores.lines import SUBPIXELS

LEAST_PX, MOST_PX = 4, 60
MOST_MM, MOST_PERCENT = 3000, 40

# the sheet, in px
WIDTH, HEIGHT, MARGIN, LINE = 860, 520, 80, 24
DOT, DASH = 2.5, 12
DISTANCE, TOO_MANY, TOO_FEW = "#1f5fa8", "#c2452d", "#d9952b"


@dataclass(frozen=True, slots=True)
class Curve:
    """A number for every disparity in sixteenths of a pixel, and how it is drawn."""

    name: str
    colour: str
    top: float
    of: Callable[[int], float]
    is_dashed: bool = False


def curves(geometry: StereoGeometry) -> tuple[Curve, Curve, Curve]:
    """Return the distance in mm, and its change in % by a pixel more and by a pixel less."""
    words = np.asarray(geometry_buffer(geometry).values, np.int32)

    def distance(disparity: int) -> float:
        return float(depth_mm(words, disparity))

    def change(disparity: int, pixels: int) -> float:
        return 100 * abs(distance(disparity + pixels * SUBPIXELS) / distance(disparity) - 1)

    return (
        Curve("distance, mm", DISTANCE, MOST_MM, distance),
        Curve(
            "error of a pixel too many, %",
            TOO_MANY,
            MOST_PERCENT,
            lambda each: change(each, 1),
            is_dashed=True,
        ),
        Curve(
            "error of a pixel too few, %",
            TOO_FEW,
            MOST_PERCENT,
            lambda each: change(each, -1),
            is_dashed=True,
        ),
    )


def figure(geometry: StereoGeometry) -> Sheet:
    """Draw the three curves: distances to the left axis, errors to the right one."""
    sheet = Sheet(width=WIDTH, height=HEIGHT)
    title = f"Distance by disparity: {geometry.focal_px:g} px, {geometry.baseline_mm:g} mm (T Figure 6.4)"
    sheet.words.append(Words(x=MARGIN, y=MARGIN / 3, text=title))
    _draw_axes(sheet)
    for number, curve in enumerate(curves(geometry)):
        sheet.boxes.extend(_dots(curve))
        y = MARGIN + LINE * (number + 1)
        sheet.words.append(
            Words(x=WIDTH - 2 * MARGIN, y=y, text=curve.name, colour=curve.colour, is_right=True)
        )
    return sheet


def _x(disparity_px: float) -> float:
    return MARGIN + (WIDTH - 2 * MARGIN) * disparity_px / MOST_PX


def _y(share: float) -> float:
    return HEIGHT - MARGIN - (HEIGHT - 2 * MARGIN) * share


def _draw_axes(sheet: Sheet) -> None:
    for tenth in range(0, 11, 2):
        y = _y(tenth / 10)
        sheet.boxes.append(FilledBox(x=MARGIN, y=y, width=WIDTH - 2 * MARGIN, height=1, fill="#dde2e9"))
        left, right = f"{MOST_MM * tenth / 10:g} mm", f"{MOST_PERCENT * tenth / 10:g} %"
        sheet.words.append(Words(x=MARGIN - 8, y=y, text=left, colour=FAINT, is_right=True))
        sheet.words.append(Words(x=WIDTH - MARGIN + 8, y=y, text=right, colour=FAINT))
    for disparity in range(0, MOST_PX + 1, 10):
        sheet.words.append(Words(x=_x(disparity) - 6, y=_y(0) + LINE, text=f"{disparity}", colour=FAINT))
    sheet.words.append(Words(x=WIDTH / 2 - 40, y=_y(0) + 2 * LINE, text="disparity, px", colour=INK))


def _dots(curve: Curve) -> Iterator[FilledBox]:
    """Boxes along a curve, so close that they are a line: straight from pixel to pixel."""
    disparities = range(LEAST_PX, MOST_PX + 1)
    corners = np.array([(_x(each), _y(curve.of(SUBPIXELS * each) / curve.top)) for each in disparities])
    way = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    places = np.arange(0, way[-1])
    for place, x, y in zip(places, *(np.interp(places, way, each) for each in corners.T), strict=True):
        if y >= MARGIN and not (curve.is_dashed and place // DASH % 2):
            yield FilledBox(x=x - DOT / 2, y=y - DOT / 2, width=DOT, height=DOT, fill=curve.colour)


def numbers(geometry: StereoGeometry) -> Table:
    """Return the curves at some disparities."""
    found = curves(geometry)
    table = new_table("T Figure 6.4", "Disparity, px", *(each.name for each in found))
    for disparity in (5, 10, 15, 20, 25, 30, 40, 50, 60):
        table.add_row(f"{disparity}", *(f"{each.of(SUBPIXELS * disparity):.1f}" for each in found))
    return table


@click.command()
@click.option("--camera", type=(float, float), default=(386.0, 30.47), metavar="FOCAL BASELINE", show_default=True,
              help="Focal length in px and distance of the cameras in mm.")  # fmt: skip
@click.option(
    "--picture", type=click.Path(path_type=Path), metavar="FILE", help="Draw it as FILE.png or FILE.svg."
)
def main(camera: tuple[float, float], picture: Path | None) -> None:
    """Show how far a line is away by its disparity, and what an error of one pixel does."""
    try:
        geometry = StereoGeometry(*camera, height_mm=0, tilt_deg=0)
        print_report(numbers(geometry))
        if picture is not None:
            picture.write_bytes(format_of(picture)(figure(geometry)))
    except (BfsimError, OSError) as error:
        raise click.ClickException(str(error)) from None


if __name__ == "__main__":
    main()
