"""The circles of the firmware against the ground truth of rendered recordings.

    python -m bfsim record scenes ball-distances ...            renders a recording
    python benchmarks/feature_quality_circles.py ball.mcap field-of-circles.mcap

A row for each ball of each frame and camera whose centre is in the picture: its true radius, the mean of the half axes of
its outline, and how far the circle nearest to it lies off, in px: with the fit and, behind, as in the thesis. The
tests passed are those of the centre (c) and of the radius (r). A ball that is hidden or cut has its whole outline
as the truth.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.seen_circles import Seen, see
from bfsim.recording import RecordingReader
from tinyphoon.stages.blob_detection import hues
from tinyphoon.stores.circles import CENTRE_PASSED, CIRCLE_EDGES, CIRCLE_TESTS, RADIUS_PASSED
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.strategy.models import MODELS, Shape, colour_groups
from tinyphoon.strategy.modes import INDOOR_FIELD, PLAIN_CIRCLES, Mode

# The hues of all balls in the rendered scenes: magenta, blue, cyan, green, yellow, orange.
COLOURS = (hues(0, 2), hues(9, 11), hues(12, 13), hues(14, 16), hues(21, 23), hues(24, 25))
MODES = {
    "fitted": INDOOR_FIELD.circles,
    "thesis": PLAIN_CIRCLES,
}


@dataclass(frozen=True, slots=True)
class Match:
    """A ball and the circle that was found for it: errors in px, and None without a circle or without a radius."""

    name: str
    radius_px: float
    edges: int
    tests: int
    centre_px: float | None
    radius_error_px: float | None


def mode_with(circles: str) -> Mode:
    """Return the mode that looks for balls of all colours."""
    ball = next(each for each in MODELS if each.shape == Shape.BALL)
    models = tuple(replace(ball, colours=each) for each in COLOURS)
    blobs = replace(INDOOR_FIELD.blobs, colour_groups=colour_groups(models))
    return replace(INDOOR_FIELD, blobs=blobs, models=models, circles=MODES[circles])


def matches(seen: Seen, width: int, height: int) -> Iterator[Match]:
    """Yield the balls of a picture, each with the circle nearest to it inside its outline."""
    truth = seen.frame.truth or {}
    for name, thing in truth.items():
        if isinstance(thing, dict) and thing.get("kind") == "ball":
            view = thing[seen.side]
            (x, y), radius = view["outline_centre_px"], float(np.mean(view["outline_half_axes_px"]))
            if not (0 <= x < width and 0 <= y < height):
                continue
            away = np.hypot(*(seen.words[:, :2] / SUBPIXELS - (x, y)).T)
            if not len(away) or away.min() > radius:
                yield Match(name, radius, 0, 0, None, None)
                continue
            words = seen.words[away.argmin()]
            tests = int(words[CIRCLE_TESTS])
            error = float(words[2] / SUBPIXELS - radius) if tests & RADIUS_PASSED else None
            yield Match(name, radius, int(words[CIRCLE_EDGES]), tests, float(away.min()), error)


def table(path: Path, limit: int | None) -> Table:
    """Return the comparison of a recording."""
    result = Table(
        title=f"{path.name}: circles, errors in px",
        title_justify="left",
        box=None,
        padding=(0, 1, 0, 0),
    )
    for name in ("frame", "camera", "ball"):
        result.add_column(name)
    result.add_column("radius", justify="right")
    for mode in MODES:
        for name in ("edges", "tests", "centre", "radius", "%"):
            result.add_column(f"{mode}\n{name}", justify="right")
    with RecordingReader(path) as reader:
        frames, size = list(reader.frames(limit)), (reader.width, reader.height)
    both = [see(frames, mode_with(mode)) for mode in MODES]
    errors: dict[str, list[float]] = {mode: [] for mode in MODES}
    for pictures in zip(*both, strict=True):
        for found in zip(*(matches(each, *size) for each in pictures), strict=True):
            cells: list[str] = []
            for mode, match in zip(MODES, found, strict=True):
                cells += _cells(match)
                if match.radius_error_px is not None:
                    errors[mode].append(match.radius_error_px / match.radius_px)
            first = found[0]
            shown = str(pictures[0].frame.index), pictures[0].side, first.name, f"{first.radius_px:.2f}"
            result.add_row(*shown, *cells)
    summary = [
        f"{mode}: {len(each)} radii, mean error {100 * np.mean(each):.2f} %, mean size {100 * np.mean(np.abs(each)):.2f} %"
        for mode, each in errors.items()
        if each
    ]
    result.caption = "\n".join(summary)
    return result


def _cells(match: Match) -> tuple[str, ...]:
    tests = ("c" if match.tests & CENTRE_PASSED else "-") + ("r" if match.tests & RADIUS_PASSED else "-")
    if match.centre_px is None:
        return "", "no blob", "", "", ""
    if match.radius_error_px is None:
        return str(match.edges), tests, f"{match.centre_px:.2f}", "", ""
    share = 100 * match.radius_error_px / match.radius_px
    return (
        str(match.edges),
        tests,
        f"{match.centre_px:.2f}",
        f"{match.radius_error_px:+.2f}",
        f"{share:+.2f}",
    )


def main() -> None:
    """Print the comparison."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("recordings", nargs="+", type=Path, help="MCAP files with ground truth")
    parser.add_argument("--frames", type=int, help="only the first stereo frames of each")
    options = parser.parse_args()
    console = Console()
    for path in options.recordings:
        console.print(table(path, options.frames))


if __name__ == "__main__":
    main()
