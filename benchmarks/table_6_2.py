"""T Table 6.2: the depth of the left and the right border of a box, by the firmware and by the thesis.

`python -m benchmarks.table_6_2 [RECORDING]`: a recording of `bfsim record render box-distances`, with any distances and
geometry; without one it is rendered here, which needs mitsuba (`pip install -e ".[scenes]"`). Two modes of ours: the
thesis's own way (lines on whole pixels, the nearest one corresponds), and ours (refined, mutually the best). A border is
found if a 3-D line lies along it in the left picture; its depth plays no part in that. The error is that of the mean of both
borders and both ends of each, beside the exact depth in the rows of these ends, as the borders lean before cameras that look
down.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from benchmarks.seen_stereo import SeenStereo, see_stereo
from bfsim.chip.boards import CM_BF561
from bfsim.errors import BfsimError
from bfsim.process.terminal import print_report, progress_bar
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.report.tables.table import new_table
from bfsim.running.inputs import calibration_of
from tinyphoon.stages.stereo_lines import Correspondence
from tinyphoon.strategy.modes import INDOOR_FIELD, Mode

PLAIN = replace(
    INDOOR_FIELD,
    refinement=replace(INDOOR_FIELD.refinement, reach=0),
    stereo_lines=replace(INDOOR_FIELD.stereo_lines, correspondence=Correspondence.NEAREST, edge_range=0),
)
"""The thesis's way."""

MODES: Mapping[str, Mode] = {"plain": PLAIN, "ours": INDOOR_FIELD}

# d_r: d_left, d_avr and the error in % as printed, of real and of synthetic pictures; nothing where the thesis has none.
Printed = tuple[float, float, float] | None
THESIS: Mapping[float, tuple[Printed, Printed]] = {
    250: ((220, 228, 8.8), (252, 253, 1.2)),
    300: ((280, 282, 6), (301, 307, 2.33)),
    350: ((342, 333, 4.86), (352, 347, 0.86)),
    400: ((428, 407, 1.75), (407, 404, 1.25)),  # 404 mm would be 1.0 %
    450: ((519, 494, 9.78), (569, 496, 10.22)),
    500: ((582, 567, 13.6), (586, 594, 18.80)),
    600: ((805, 801, 33.34), (691, 704, 17.33)),
    700: (None, (812, 794, 13.43)),
    800: (None, None),
    1000: (None, None),
}

BORDERS = ("front left", "front right")
NEAR_PX = 3.0
"""How far the ends of a line may be from a border in the left picture; the borders are 30 px and more apart."""

Points = NDArray[np.float64]


def border_lines(truth: Mapping[str, Any], seen: Points) -> list[tuple[Points, Points] | None]:
    """Return for each border the found line's two ends and the border's exact points in the same rows, in mm."""
    camera = truth["cameras"]["left"]
    rotation, focal_px = np.array(camera["rotation"]), camera["focal_px"]
    found = []
    for name in BORDERS:
        ends_mm = (np.array(truth["box"]["edges"][name]["ends_mm"]) - camera["position_mm"]) @ rotation.T
        found.append(_longest([_beside(line, ends_mm, focal_px) for line in seen]))
    return found


def _beside(line: Points, ends_mm: Points, focal_px: float) -> tuple[Points, Points] | None:
    """Return a found line and the border in its rows, if both are one line in the left picture."""
    columns, rows = (focal_px * line[:, axis] / line[:, 2] for axis in (0, 1))
    border_rows = focal_px * ends_mm[:, 1] / ends_mm[:, 2]
    # one over the depth grows evenly over the rows of a picture, and so does column by depth
    share = (rows - border_rows[0]) / (border_rows[1] - border_rows[0])
    inverse = (1 - share) / ends_mm[0, 2] + share / ends_mm[1, 2]
    across = (1 - share) * ends_mm[0, 0] / ends_mm[0, 2] + share * ends_mm[1, 0] / ends_mm[1, 2]
    if np.abs(columns - focal_px * across).max() > NEAR_PX or not (np.abs(share - 0.5) < 1).all():
        return None
    depths = 1 / inverse
    return line, np.stack([across * depths, rows / focal_px * depths, depths], axis=1)


def _longest(lines: Sequence[tuple[Points, Points] | None]) -> tuple[Points, Points] | None:
    return max(
        (each for each in lines if each is not None),
        key=lambda each: float(abs(np.diff(each[0][:, 1])[0])),
        default=None,
    )


def measured(frame: StereoFrame, seen: SeenStereo) -> Printed:
    """Return d_left, d_avr and the error in % of a frame, or None unless both borders are found."""
    assert frame.truth
    found = [each for each in border_lines(frame.truth, seen.lines_mm) if each is not None]
    if len(found) < len(BORDERS):
        return None
    depths = [line[:, 2].mean() for line, _ in found]
    ratio = np.mean([line[:, 2].mean() / exact[:, 2].mean() for line, exact in found])
    return float(depths[0]), float(np.mean(depths)), float(100 * abs(ratio - 1))


def distance_mm(truth: Mapping[str, Any]) -> float:
    """Return how far the box's front is before the cameras, over the floor."""
    left_x_mm = truth["cameras"]["left"]["position_mm"][0]
    return float(min(point[0] for point in truth["box"]["edges"]["bottom front"]["ends_mm"]) - left_x_mm)


def comparison(recording: Path) -> Table:
    """Return the table of the thesis, and beside it ours."""
    with RecordingReader(recording) as reader:
        frames, calibration = list(reader.frames()), calibration_of(reader)
    seen = {name: see_stereo(frames, calibration, mode) for name, mode in MODES.items()}
    titles = ("Thesis, real", "Thesis, synthetic", "Ours, the thesis's way", "Ours")
    title = "T Table 6.2: depth of a box's left border and mean of both in mm, error in %"
    table = new_table(title, "At", *titles, "Better")
    for number, frame in enumerate(frames):
        assert frame.truth
        distance = distance_mm(frame.truth)
        real, synthetic = THESIS.get(round(distance), (None, None))
        plain, ours = (measured(frame, each[number]) for each in seen.values())
        is_better = ours is not None and (synthetic is None or ours[2] < synthetic[2])
        better = ("yes" if is_better else "no") if round(distance) in THESIS else "-"
        cells = [_cell(each) for each in (real, synthetic, plain, ours)]
        table.add_row(f"{distance:.0f}", *cells, better)
    table.caption = "; ".join(f"{name}: {_cost(each)}" for name, each in seen.items())
    return table


def _cell(numbers: Printed) -> str:
    return "-" if numbers is None else "{:.0f} {:.0f} {:5.2f}".format(*numbers)


def _cost(seen: Sequence[SeenStereo]) -> str:
    """Say what lines and 3-D lines cost core A."""

    def ms(stage: str) -> float:
        return float(1000 * np.mean([each.stages_cclk[stage] for each in seen]) / CM_BF561.clocks.cclk_hz)

    return f"lines {ms('Line detection'):.2f} ms, 3-D lines {1000 * ms('3-D lines'):.0f} us"


def with_recording(path: Path | None, show: Callable[[Path], None]) -> None:
    """Call `show` with a recording of the box, rendered for the time being if there is none."""
    if path is not None:
        show(path)
        return
    from bfsim.recording.scenes import render
    from tinyphoon.scenes.distances import BOX_DISTANCES

    with TemporaryDirectory() as folder:
        with progress_bar("Rendering") as progress:
            (rendered,) = render(BOX_DISTANCES, Path(folder) / "box.mcap", progress=progress)
        show(rendered)


@click.command()
@click.argument("recording", required=False, type=click.Path(path_type=Path))
def main(recording: Path | None) -> None:
    """Print T Table 6.2 beside what the firmware measures in RECORDING, or in pictures that are rendered for it."""
    try:
        with_recording(recording, lambda path: print_report(comparison(path)))
    except BfsimError as error:
        raise click.ClickException(str(error)) from None


if __name__ == "__main__":
    main()
