"""The vision firmware of the robot Tinyphoon for both cores of its ADSP-BF561. T is the thesis it follows."""

from __future__ import annotations

from bfsim.api import BudgetRow, Firmware
from firmware.buffers import buffers
from firmware.core_a import core_a
from firmware.core_b import core_b

tinyphoon = Firmware(
    mains={"A": core_a, "B": core_b},
    buffers=buffers,
    camera="camera",
    rows=(
        BudgetRow(stage="Edge detection", thesis_ms=87.0),  # T Table 6.4, average
        BudgetRow(stage="Open & closing", thesis_ms=26.0),
    ),
)
