"""Firmware on the CM-BF561 as the thesis places it, and what its memories have at the end of each frame."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Generic, TypeVar

from bfsim.api import Firmware, FrameSize, Readout, Script
from bfsim.chip.boards import CM_BF561
from bfsim.linker import link, parse_ldf
from bfsim.machine.board import Board
from bfsim.machine.peripherals.table import devices_of
from bfsim.machine.symbols import symbols_of
from bfsim.recording import StereoFrame
from bfsim.shipped import DEFAULT_LDFS
from bfsim.trace import FrameRecord

Taken = TypeVar("Taken")


@dataclass(frozen=True, slots=True)
class Played(Generic[Taken]):
    """A frame: its record, and what was taken from the memories of each core, left before right."""

    record: FrameRecord
    taken: Mapping[str, Taken]

    def results(self, core: str) -> dict[str, int]:
        """Return the numbers that a core published."""
        ending = f"_{core}"
        named = self.record.results.items()
        return {name.removesuffix(ending): value for name, value in named if name.endswith(ending)}

    def stages_cclk(self, core: str) -> dict[str, int]:
        """Return the cycles of each stage of a core."""
        (own,) = (each for each in self.record.cores if each.core == core)
        return {each.stage: each.elapsed_cclk for each in own.stages}


def play(
    frames: Sequence[StereoFrame],
    firmware: Firmware,
    take: Callable[[Readout], Taken],
    on_frame: Callable[[FrameRecord], None] | None = None,
    script: Script = MappingProxyType({}),
) -> list[Played[Taken]]:
    """Play frames of one size on one board, and `take` from each core's memories what is wanted: no time passes.

    `script`: what the other end of the SPI orders.
    """
    taken: dict[tuple[int, str], Taken] = {}

    def view(readout: Readout) -> None:
        taken[readout.frame.index, readout.core] = take(readout)

    height, double_width = frames[0].left.shape
    size = FrameSize(double_width // 2, height)
    firmware = replace(firmware, view=view)
    places = link(parse_ldf(DEFAULT_LDFS["ADSP-BF561"]), symbols_of(firmware, size), CM_BF561.chip.regions)
    board = Board(CM_BF561, firmware, size, places, devices=devices_of(firmware, script))
    outcome = board.run(iter(frames), on_frame, on_seen=lambda _index, _seen: None)
    return [
        Played(record, {each.core: taken[record.index, each.core] for each in record.cores})
        for record in outcome.frames
    ]
