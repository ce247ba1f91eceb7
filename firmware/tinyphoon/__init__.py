"""The vision firmware of the robot Tinyphoon for both cores of its ADSP-BF561. T is the thesis that it follows."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from bfsim.api import BudgetRow, Firmware, Reference
from tinyphoon.buffers import buffers, calibration_buffers, one_core_buffers
from tinyphoon.core_a import core_a
from tinyphoon.core_b import core_b
from tinyphoon.geometry import THESIS_GEOMETRY
from tinyphoon.losses import LOSSES, THESIS_LOSSES
from tinyphoon.one_core import one_core
from tinyphoon.strategy.modes import THESIS_FIELD
from tinyphoon.strategy_unit.unit import StrategyUnit
from tinyphoon.variants import (
    FAST,
    RECTIFIED_FEATURES,
    THESIS,
    fast_buffers,
    mains,
    places_calibration,
    thesis_buffers,
    thesis_calibration,
)
from tinyphoon.view.picture_colours import picture_colours
from tinyphoon.view.view import view

TABLE_6_4 = Reference(
    name="thesis",
    about="average ms of a frame of 320x240 on the robot (thesis, Table 6.4).",
)

STAGES = (
    BudgetRow(stage="Edge detection", reference_ms=87.0),
    BudgetRow(stage="Open & closing", reference_ms=26.0),
    BudgetRow(stage="Blob detection", reference_ms=68.0),
    BudgetRow(stage="Line detection", reference_ms=19.0),  # 3-D lines and edges included
    BudgetRow(stage="Shape detection", reference_ms=18.0),
    BudgetRow(stage="Object detection", reference_ms=1.0),
)


def rows(rectified_in: str) -> tuple[BudgetRow, ...]:
    """Return the stages, with the rectification as a part of one of them."""
    part = BudgetRow(stage="Rectification", within=rectified_in)
    after = 1 + [each.stage for each in STAGES].index(rectified_in)
    return *STAGES[:after], part, *STAGES[after:]


ROWS = rows(rectified_in="Edge detection")

tinyphoon = Firmware(
    mains={"A": core_a, "B": core_b},
    buffers=buffers,
    camera="camera",
    rows=ROWS,
    reference=TABLE_6_4,
    calibration=calibration_buffers,
    spi=StrategyUnit,
    view=view,
    colours=picture_colours,
    losses=LOSSES,
    assumed_geometry=THESIS_GEOMETRY,
)

fast = replace(tinyphoon, mains=mains(FAST), buffers=fast_buffers)
"""The same features of the same pictures, in a third of the time."""

thesis = replace(
    tinyphoon,
    mains=mains(THESIS),
    buffers=thesis_buffers,
    calibration=thesis_calibration,
    spi=partial(StrategyUnit, mode=THESIS_FIELD),
    colours=partial(picture_colours, mode=THESIS_FIELD),
    losses=THESIS_LOSSES,
)
"""The steps that the thesis describes: what the robot ran, as far as the thesis says. Lines are found differently."""

rectified_features = replace(
    tinyphoon,
    mains=mains(RECTIFIED_FEATURES),
    calibration=places_calibration,
    rows=rows(rectified_in="Line detection"),
)
"""The features of unrectified pictures, rectified in place of the pictures (T §7.2)."""

one_eye = replace(tinyphoon, mains={"A": one_core}, buffers=one_core_buffers)
"""The same stages for a board with one core and one camera, such as cm-bf533."""
