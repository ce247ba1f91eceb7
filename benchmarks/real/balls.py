"""Balls in real pictures with boxes drawn by people: how many are found, by size, and what else is taken for one.

The pictures and boxes are those of `benchmarks/soccer_msl.py`, which says how the recording and its mode are made.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from benchmarks import soccer_msl
from bfsim.report.tables.table import percent
from tinyphoon.stores.objects import OBJECT_TESTS

TITLE = "Balls of a robot-soccer hall, by the width of their boxes"
COLUMNS = "tests passed", "to 12 px", "to 24 px", "wider", "all", "% found", "false a picture"
NOTE = "Found of those that there are. The table of tests: a ball passes more of them the better it is seen."
WIDTHS_PX = (12, 24)
SIZE = (608, 368)


def rows_of(folder: Path) -> list[list[str]]:
    """Return the rows of the table for a folder of pictures with YOLO boxes."""
    paths = sorted(each for each in folder.glob("*.jpg") if each.with_suffix(".txt").exists())
    with tempfile.TemporaryDirectory() as made:
        seen, boxes = soccer_msl.see_balls(paths, Path(made), SIZE)
    rows = []
    for level, test in soccer_msl.LEVELS.items():
        found, there = np.zeros(len(WIDTHS_PX) + 1, int), np.zeros(len(WIDTHS_PX) + 1, int)
        for each, balls in zip(seen, boxes, strict=True):
            records = each.left[(each.left[:, OBJECT_TESTS] & test) != 0]
            for box in balls:
                band = int(np.searchsorted(WIDTHS_PX, box[2]))
                there[band] += 1
                found[band] += bool(soccer_msl.on_ball(records, box).any())
        false = soccer_msl.count(seen, boxes)[level].false
        by_band = [f"{one} of {all_}" for one, all_ in zip(found, there, strict=True)]
        rows.append(
            [
                level,
                *by_band,
                f"{found.sum()} of {there.sum()}",
                percent(found.sum(), there.sum()),
                f"{false / len(seen):.2f}",
            ]
        )
    return rows
