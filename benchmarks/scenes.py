"""The scenes of T Figures 5.8 and 6.7 to 6.14: which objects the firmware finds, and how far off it has them.

`python -m benchmarks.scenes FOLDER`: a folder of recordings of `bfsim record render thesis FOLDER`. What the thesis
reports as failing is reported here as it comes out. A thing is found if an object of its kind of model lies its way; its
place is that of the ball's centre, of the middle of the goal's mouth, and of the middle of the mark's nearest face. The
goal is open: what is seen is mostly its back, 150 mm behind the mouth. The balls of Figure 5.8 have many colours and sizes,
and the model one of each.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from benchmarks.seen_objects import Seen, see
from bfsim.report.tables import new_table
from bfsim.terminal import print_report, progress_bar
from firmware.stores.objects import DIMENSION_TEST
from firmware.strategy.decoding import ReportedObject
from firmware.strategy.models import MODELS, Shape

PLACED_BY = {Shape.GOAL: "mouth_mm", Shape.MARKER: "mark_corners_mm", Shape.BALL: "centre_mm"}
"""What of the ground truth tells where a thing is, and with it what it is."""

SHAPE_OF = {each.number: each.shape for each in MODELS}

SLACK_DEG = 1.0
"""Objects no farther from the way to a thing than its own half width, and this, are taken for it."""

Vector = NDArray[np.float64]


@dataclass(slots=True)
class Tally:
    """What came out for one thing over the frames of a scene."""

    frames: int = 0
    directions_deg: list[float] = field(default_factory=list)
    places_mm: list[float] = field(default_factory=list)
    depths_mm: list[tuple[float, float]] = field(default_factory=list)
    accuracies: list[int] = field(default_factory=list)


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


def compare(seen: Sequence[Seen]) -> tuple[dict[str, Tally], int]:
    """Return what came out for each thing, and how many objects with the dimension of their model are no thing."""
    tallies: dict[str, Tally] = {}
    false = 0
    for each in seen:
        now = [found for found in each.results.objects if found.age == 0]
        taken: set[int] = set()
        for name, thing in things(each.truth):
            place = place_of(thing, each.truth["cameras"]["left"])
            tally = tallies.setdefault(name, Tally())
            tally.frames += 1
            reach_deg = half_width_deg(thing, place) + SLACK_DEG
            near = [
                index for index, found in enumerate(now)
                if SHAPE_OF[found.model] == shape_of(thing)
                and angle_deg(np.array(found.towards, float), place) <= reach_deg
            ]  # fmt: skip
            if near:
                best = max(near, key=lambda index: now[index].accuracy)
                taken.update(near)
                _add(tally, now[best], place)
        false += sum(
            1 for index, found in enumerate(now) if index not in taken and found.tests & DIMENSION_TEST
        )
    return tallies, false


def _add(tally: Tally, found: ReportedObject, place: Vector) -> None:
    towards = np.array(found.towards, float)
    tally.accuracies.append(found.accuracy)
    tally.directions_deg.append(angle_deg(towards, place))
    if found.has_place:
        tally.places_mm.append(float(np.linalg.norm(towards - place)))
        tally.depths_mm.append((place[2], towards[2]))


def add_rows(table: Table, scene: str, tallies: Mapping[str, Tally], false: int) -> None:
    """Add a scene to the table."""
    for name, tally in tallies.items():
        depths = np.array(tally.depths_mm)
        off = np.abs(depths[:, 1] / depths[:, 0] - 1) if len(depths) else np.zeros(0)
        table.add_row(
            *(scene, name, f"{len(tally.accuracies)} of {tally.frames}", f"{len(tally.places_mm)}"),
            *(_mean(tally.directions_deg, ".1f"), _mean(tally.places_mm, ".0f"), _mean(100 * off, ".1f")),
            _mean(tally.accuracies, ".0f"),
        )
        scene = ""
    table.add_row("", "objects that are no thing", f"{false}")
    table.add_section()


def _mean(values: Sequence[float] | NDArray[np.float64], form: str) -> str:
    return format(np.mean(values), form) if len(values) else "-"


@click.command()
@click.argument("folder", type=click.Path(exists=True, file_okay=False, path_type=Path))
def main(folder: Path) -> None:
    """Print for each recording in FOLDER that has ground truth what the firmware finds of it."""
    heads = ("Found", "with place", "direction, deg", "place, mm", "depth, %", "accuracy")
    table = new_table("Things found, and the mean error of those found", "Scene", "Thing", *heads)
    paths = sorted(folder.glob("*.mcap"))
    with progress_bar("Simulating") as progress:
        for done, path in enumerate(paths):
            progress(done, len(paths))
            tallies, false = compare(see(path))
            if tallies:
                add_rows(table, path.stem, tallies, false)
    print_report(table)


if __name__ == "__main__":
    main()
