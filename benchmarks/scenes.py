"""The scenes of T Figures 5.8 and 6.7 to 6.14: which objects the firmware finds, and how far off it has them.

`python -m benchmarks.scenes [FOLDER] [--scene NAME]... [--overlays FOLDER]`: a folder of recordings of `bfsim record
render thesis FOLDER`; without one they are rendered here, which needs mitsuba (`pip install -e ".[scenes]"`) and some
minutes. What the thesis reports as failing is reported here as it comes out. A thing is found if an object of its kind
of model lies its way; its place is that of the ball's centre, of the middle of the goal's mouth, and of the middle of
the mark's nearest face. The balls of Figure 5.8 have many colours and sizes, and the model one of each. What was seen
is drawn over the pictures of each scene, in a folder of its own.
"""

from __future__ import annotations

import tempfile
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from bfsim.api import Seen
from bfsim.errors import BfsimError
from bfsim.process.terminal import print_report, progress_bar
from bfsim.recording import RecordingReader
from bfsim.report.overlay.files import OverlayWriter
from bfsim.report.tables.table import new_table
from bfsim.run import simulate
from bfsim.seen import SeenFrame, SeenObject
from tinyphoon.scenes.thesis import FIGURES
from tinyphoon.strategy.models import MODELS, Shape

PLACED_BY = {Shape.GOAL: "mouth_mm", Shape.MARKER: "mark_corners_mm", Shape.BALL: "centre_mm"}
"""What of the ground truth tells where a thing is, and with it what it is."""

SHAPE_OF = {each.name: each.shape for each in MODELS}

SLACK_DEG = 1.0
"""Objects no farther from the way to a thing than its own half width, and this, are taken for it."""

TALLY_HEADS = ("Found", "with place", "direction, deg", "place, mm", "depth, %", "accuracy, %")

Vector = NDArray[np.float64]


@dataclass(slots=True)
class Tally:
    """What came out for one thing over the frames of a scene."""

    frames: int = 0
    directions_deg: list[float] = field(default_factory=list)
    places_mm: list[float] = field(default_factory=list)
    depths_mm: list[tuple[float, float]] = field(default_factory=list)
    accuracies: list[float] = field(default_factory=list)


def shape_of(thing: Any) -> Shape | None:
    """Return the shape of a thing's model; None if there is no model of it."""
    return next(
        (shape for shape, name in PLACED_BY.items() if isinstance(thing, dict) and name in thing), None
    )


def place_of(thing: Mapping[str, Any], camera: Mapping[str, Any]) -> Vector:
    """Return where a thing is in the frame of the left camera, in mm."""
    shape = shape_of(thing)
    corners = np.array(thing[PLACED_BY[shape]])
    inside = (corners - np.array(camera["position_mm"])) @ np.array(camera["rotation"]).T
    if shape == Shape.BALL:
        return np.asarray(inside)
    if shape == Shape.GOAL:
        return np.asarray(inside.mean(axis=0))
    nearest = np.argsort(np.hypot(*(corners[:4, :2] - np.array(camera["position_mm"])[:2]).T))[:2]
    return np.asarray(inside[[*nearest, *(nearest + 4)]].mean(axis=0))


def angle_deg(one: Vector, other: Vector) -> float:
    """Return the angle between two directions."""
    cosine = one @ other / np.linalg.norm(one) / np.linalg.norm(other)
    return float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))


def half_width_deg(thing: Mapping[str, Any], place: Vector) -> float:
    """Return how wide half a thing looks from where the camera is."""
    if shape_of(thing) == Shape.BALL:
        half_mm = thing["radius_mm"]
    elif shape_of(thing) == Shape.GOAL:
        half_mm = np.ptp(np.array(thing["mouth_mm"]), axis=0).max() / 2
    else:
        half_mm = thing["side_mm"] / 2
    return float(np.degrees(np.arctan2(half_mm, np.linalg.norm(place))))


def things(truth: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the things of a scene that there are models for."""
    for name, thing in truth.items():
        if shape_of(thing) is not None:
            yield name, thing


def thing_of(found: SeenObject, truth: Mapping[str, Any], places: Mapping[str, Vector]) -> str | None:
    """Return the thing of its shape that lies nearest to the way to an object; None if that is too far from it."""
    off_deg = {
        name: angle_deg(np.array(found.place_mm, float), place)
        for name, place in places.items()
        if shape_of(truth[name]) == SHAPE_OF[found.name]
    }
    nearest = min(off_deg, key=lambda name: off_deg[name], default=None)
    if nearest is None or off_deg[nearest] > half_width_deg(truth[nearest], places[nearest]) + SLACK_DEG:
        return None
    return nearest


def compare(
    frames: Iterable[tuple[SeenFrame | Seen, Mapping[str, Any]]],
) -> tuple[dict[str, Tally], list[float]]:
    """Return what came out for each thing of frames with their ground truth, and how accurate what is no thing is said to be.

    Of the latter those only that have the dimension of their model.
    """
    tallies: dict[str, Tally] = {}
    false: list[float] = []
    for seen, truth in frames:
        now = [found for found in seen.objects if found.age_frames == 0]
        left = truth["cameras"]["left"]
        places = {name: place_of(thing, left) for name, thing in things(truth)}
        meant: dict[str, list[SeenObject]] = {name: [] for name in places}
        for found in now:
            name = thing_of(found, truth, places)
            if name is not None:
                meant[name].append(found)
            elif "dimension" in found.tests:
                false.append(found.accuracy)
        for name, candidates in meant.items():
            tally = tallies.setdefault(name, Tally())
            tally.frames += 1
            if candidates:
                _add(tally, max(candidates, key=lambda each: each.accuracy), places[name])
    return tallies, false


def _add(tally: Tally, found: SeenObject, place: Vector) -> None:
    towards = np.array(found.place_mm, float)
    tally.accuracies.append(found.accuracy)
    tally.directions_deg.append(angle_deg(towards, place))
    if not found.is_direction:
        tally.places_mm.append(float(np.linalg.norm(towards - place)))
        tally.depths_mm.append((place[2], towards[2]))


def tally_cells(tally: Tally) -> list[str]:
    """Return the cells of a thing."""
    depths = np.array(tally.depths_mm)
    off = np.abs(depths[:, 1] / depths[:, 0] - 1) if len(depths) else np.zeros(0)
    return [
        *(f"{len(tally.accuracies)} of {tally.frames}", f"{len(tally.places_mm)}"),
        *(_mean(tally.directions_deg, ".1f"), _mean(tally.places_mm, ".0f"), _mean(100 * off, ".1f")),
        _mean(100 * np.array(tally.accuracies), ".0f"),
    ]


def add_rows(table: Table, scene: str, tallies: Mapping[str, Tally], false: Sequence[float]) -> None:
    """Add a scene to the table."""
    for name, tally in tallies.items():
        table.add_row(scene, name, *tally_cells(tally))
        scene = ""
    best = f"{100 * max(false):.0f} at most" if false else ""
    table.add_row("", "no thing", f"{len(false)}", "", "", "", "", best)
    table.add_section()


def _mean(values: Sequence[float] | NDArray[np.float64], form: str) -> str:
    return format(np.mean(values), form) if len(values) else "-"


def run_scene(recording: Path, overlays: Path) -> list[tuple[SeenFrame, Mapping[str, Any]]]:
    """Run a recording through the firmware, draw each frame in the folder `overlays`, and return them with their truth."""
    seen: list[SeenFrame] = []
    with OverlayWriter(overlays) as writer:

        def take(frame: SeenFrame) -> None:
            writer.add(frame)
            seen.append(frame)

        simulate(recording, on_seen=take)
    with RecordingReader(recording) as reader:
        return [(each, picture.truth or {}) for each, picture in zip(seen, reader.frames(), strict=True)]


def recordings(folder: Path, scenes: Collection[str]) -> list[Path]:
    """Return the recordings of some scenes in a folder, of all without a name."""
    return sorted(path for path in folder.glob("*.mcap") if not scenes or path.stem in scenes)


def comparison(paths: Sequence[Path], overlays: Path) -> Table:
    """Return what is found of the things in each recording that has some."""
    table = new_table("Things found, and the mean error of those found", "Scene", "Thing", *TALLY_HEADS)
    overlays.mkdir(exist_ok=True)
    with progress_bar("Simulating") as progress:
        for done, path in enumerate(paths):
            progress(done, len(paths))
            tallies, false = compare(run_scene(path, overlays / path.stem))
            if tallies:
                add_rows(table, path.stem, tallies, false)
    return table


@click.command()
@click.argument("folder", type=click.Path(exists=True, file_okay=False, path_type=Path), required=False)
@click.option(
    "--scene", "scenes", multiple=True, type=click.Choice(sorted(FIGURES)), help="Only this; again for more."
)
@click.option(
    "--overlays",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("scenes-seen"),
    help="Folder for the pictures of what was seen.",
    show_default=True,
)
def main(folder: Path | None, scenes: tuple[str, ...], overlays: Path) -> None:
    """Print for each recording in FOLDER that has ground truth what the firmware finds of it, and draw it."""
    try:
        with tempfile.TemporaryDirectory() as rendered:
            if folder is None:
                from bfsim.recording.scenes import render

                folder = Path(rendered)
                with progress_bar("Rendering the scenes") as progress:
                    render({name: FIGURES[name] for name in scenes or FIGURES}, folder, progress=progress)
            print_report(comparison(recordings(folder, scenes), overlays))
    except BfsimError as error:
        raise click.ClickException(str(error)) from None


if __name__ == "__main__":
    main()
