"""How well boxes are placed: `python -m benchmarks.boxes RECORDING` with one of `tinyphoon.scenes.boxes:BOXES`.

Each frame with where the box is, and how far off its middle is that the firmware reports: by its upright edges, or by
the floor alone.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from bfsim.api import Script
from bfsim.process.terminal import print_report
from bfsim.recording import RecordingReader
from bfsim.report.tables.table import new_table
from bfsim.run import simulate
from tinyphoon import tinyphoon
from tinyphoon.scenes.boxes import ANGLES_DEG, BOX, DISTANCES_MM
from tinyphoon.stores.objects import BY_DISPARITY
from tinyphoon.strategy_unit.decoding import ReportedObject, decode_results
from tinyphoon.strategy_unit.messages import MessageType
from tinyphoon.strategy_unit.unit import StrategyUnit

DEPTH_MM, WIDTH_MM, HEIGHT_MM = BOX.size_mm
ORDER = {
    "name": "crate", "shape": "box", "colour": "green", "width_mm": WIDTH_MM, "height_mm": HEIGHT_MM, "depth_mm": DEPTH_MM,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Placed:
    """A frame: how far the box is from the left camera, and what was reported of it."""

    far_mm: float
    found: ReportedObject | None
    off_mm: float

    @property
    def way(self) -> str:
        """How it was placed."""
        if self.found is None:
            return "not found"
        if not self.found.has_place:
            return "direction"
        return "edges" if self.found.measures & BY_DISPARITY else "floor"

    @property
    def cell(self) -> str:
        """How far off its place is, if it has one, and how it was placed."""
        has_place = self.found is not None and self.found.has_place
        return f"{self.off_mm:.0f} {self.way}" if has_place else self.way


def placed(recording: Path) -> list[Placed]:
    """Return what the firmware reports of the box in each frame, the most accurate object of its model."""
    units: list[StrategyUnit] = []

    def unit(_script: Script) -> StrategyUnit:
        units.append(StrategyUnit({"send": [{"models": [ORDER]}]}))
        return units[-1]

    simulate(recording, firmware=replace(tinyphoon, spi=unit))
    messages = [each.message for each in units[-1].received if each.message.type is MessageType.RESULTS]
    with RecordingReader(recording) as reader:
        cameras = [(frame.truth or {})["cameras"]["left"] for frame in reader.frames()]
    return [
        _placed(decode_results(message.payload).objects, camera)
        for message, camera in zip(messages, cameras, strict=True)
    ]


def _placed(objects: Sequence[ReportedObject], camera: Mapping[str, Any]) -> Placed:
    middle = np.add(BOX.foot_mm, (0, 0, HEIGHT_MM / 2))
    place = (middle - camera["position_mm"]) @ np.array(camera["rotation"]).T
    seen = [each for each in objects if each.age == 0]
    found = max(seen, key=lambda each: each.accuracy, default=None)
    off_mm = float(np.linalg.norm(np.array(found.towards) - place)) if found else 0.0
    return Placed(float(np.linalg.norm(place)), found, off_mm)


def comparison(frames: Sequence[Placed]) -> Table:
    """Return a row for each distance, a column for each side that the robot sees."""
    table = new_table(
        "Box of 120 x 80 x 70 mm: how far off its middle is, mm (and how it was placed)", "At mm"
    )
    for angle in ANGLES_DEG:
        table.add_column(f"{angle} deg", justify="right")
    rows = iter(frames)
    for distance in DISTANCES_MM:
        cells = [each.cell for each in islice(rows, len(ANGLES_DEG))]
        table.add_row(f"{distance}", *cells)
    for way in ("edges", "floor"):
        parts = [each.off_mm / each.far_mm for each in frames if each.way == way]
        if parts:
            mean, most = 100 * np.mean(parts), 100 * max(parts)
            table.caption = f"{table.caption or ''} by {way}: {len(parts)} frames, {mean:.1f} % of the distance, at most {most:.1f}."
    return table


def main() -> None:
    """Print the table of a recording."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("recording", type=Path, help="one of a box that stands still")
    print_report(comparison(placed(parser.parse_args().recording)))


if __name__ == "__main__":
    main()
