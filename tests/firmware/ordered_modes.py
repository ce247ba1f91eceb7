"""Frames that are played in modes which the strategy unit orders, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bfsim.api import Firmware, FrameSize
from bfsim.chip.boards import CM_BF561
from bfsim.linker import link
from bfsim.machine.board import Board
from bfsim.machine.symbols import symbols_of
from bfsim.recording import StereoFrame
from bfsim.trace import BoardRecord
from tests.machine.placements import shipped
from tinyphoon import tinyphoon
from tinyphoon.strategy_unit.unit import StrategyUnit


def run(
    frames: Sequence[StereoFrame],
    *names: dict[str, Any],
    firmware: Firmware = tinyphoon,
    ldf: str = "thesis.ldf",
) -> tuple[Board, BoardRecord]:
    """Play the frames; mode number n of `names` comes in frame n, to be in force in the next one; the first one is in force from the start."""
    height, double_width = frames[0].left.shape
    size = FrameSize(double_width // 2, height)
    link_map = link(shipped(ldf), symbols_of(firmware, size), CM_BF561.chip.regions)
    send = [{"after_frames": number, "mode": each} for number, each in enumerate(names)]
    board = Board(CM_BF561, firmware, size, link_map, devices={"SPI": StrategyUnit({"send": send})})
    return board, board.run(iter(frames))
