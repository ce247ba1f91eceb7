"""Place firmware in the memory of a board, or say how large its pictures can be at most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bfsim.chip.memory_map import Region, region_of
from bfsim.chip.spec import BoardSpec
from bfsim.errors import BfsimError, LinkError
from bfsim.kernel.build import Build
from bfsim.linker import LinkerScript, LinkMap, link
from bfsim.machine.buffers import FrameSize
from bfsim.machine.program import Calibration, Firmware, SourcePixels
from bfsim.machine.symbols import symbols_of
from bfsim.process.once import once

_WIDTH_STEP, _HEIGHT_STEP = 4, 2
"""Steps of the sizes that are tried: half a picture has whole pairs of pixels, a quarter has whole rows."""


def place(
    firmware: Firmware,
    calibration: Calibration,
    size: FrameSize,
    placement: LinkerScript,
    spec: BoardSpec,
    build: Build,
) -> LinkMap:
    """Return where the linker puts the firmware for pictures of `size`.

    Raises LinkError, which names the largest pictures of the same shape that fit, if smaller ones do.
    """

    def placed(size: FrameSize) -> LinkMap:
        return _placed(
            firmware,
            calibration,
            size.width_px,
            size.height_px,
            placement,
            spec.chip.regions,
            spec.chip.name,
            build,
        )

    def fits(step: int) -> bool:
        try:
            placed(_scaled(size, step))
        except BfsimError:
            return False
        return True

    try:
        return placed(size)
    except LinkError as error:
        least, most = 1, size.width_px // _WIDTH_STEP + 1
        if not fits(least):
            raise
        while most - least > 1:
            middle = (least + most) // 2
            least, most = (middle, most) if fits(middle) else (least, middle)
        largest = _scaled(size, least)
        raise LinkError(
            f"pictures of {size} need more memory than there is: the largest of this shape that this firmware takes with this "
            f"LDF are {largest}, and `bfsim record import --resize {largest}` scales them; {error}"
        ) from error


@once
def _placed(
    firmware: Firmware,
    calibration: Calibration,
    width_px: int,
    height_px: int,
    placement: LinkerScript,
    regions: Sequence[Region],
    chip: str,
    build: Build,
) -> LinkMap:
    size = FrameSize(width_px, height_px)
    symbols = symbols_of(firmware.calibrated(_cut(calibration, size)), size, build)
    return link(placement, symbols, regions, chip=chip)


def _scaled(size: FrameSize, step: int) -> FrameSize:
    """Return the size that is `step` steps wide, of the same shape, rounded down, but at least one step high."""
    width = step * _WIDTH_STEP
    height = max(size.height_px * width // size.width_px // _HEIGHT_STEP, 1) * _HEIGHT_STEP
    return replace(size, width_px=width, height_px=height)


def _cut(calibration: Calibration, size: FrameSize) -> Calibration:
    """Return the calibration with as many source pixels as smaller pictures have."""
    return replace(
        calibration,
        sources={
            core: SourcePixels(
                np.minimum(source.rows[: size.height_px, : size.width_px], size.height_px - 1),
                np.minimum(source.columns[: size.height_px, : size.width_px], size.width_px - 1),
            )
            for core, source in calibration.sources.items()
        },
    )


def outside_l1(link_map: LinkMap, regions: Sequence[Region]) -> frozenset[str]:
    """Return the names of symbols that lie in L2 or SDRAM, whichever core's they are."""
    return frozenset(
        each.symbol.name
        for each in link_map.placements
        if region_of(each.address, each.symbol.nbytes, regions).owner == "shared"
    )
