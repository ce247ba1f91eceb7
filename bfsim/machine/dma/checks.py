"""What the chip flags in the programming of a DMA channel before a word has moved. Each check raises MmrError.

A work unit must stay in one memory, even if the next memory is adjacent. One that jumps from memory to memory
without touching anything in between is refused here, though the chip might let it pass.

NOTE: silicon anomaly 05000301 is not checked: on early revisions, a memory stream can hang if its source and
destination descriptors lie in different memory spaces. Keep both chains in the same one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn

from bfsim.chip.dma_channels import ChannelSpec, Direction
from bfsim.chip.memory_map import Region
from bfsim.machine.dma.config import DmaConfig
from bfsim.machine.dma.mmr import refuse
from bfsim.machine.dma.unit import WorkUnit


@dataclass(frozen=True, slots=True)
class DmaSpace:
    """The memories of a board, and the parts of L1 currently used as cache, which no DMA may touch."""

    regions: tuple[Region, ...]
    cached: tuple[Region, ...] = ()

    def check(
        self, channel: ChannelSpec, register: str, start: int, span: tuple[int, int], where: str
    ) -> None:
        """Raise MmrError unless `channel` reaches all bytes of `span`, in the memory that holds address `start`.

        `register` is the one that holds `start`.
        """
        subject = f"{channel.name}_{register}"
        lowest, highest = span
        region = next((each for each in self.regions if each.holds(start, 1)), None)
        if region is None:
            refuse(f"{subject} must point into a memory, not to 0x{start:08X} where there is none", where)
        if region.memory not in channel.controller.reaches:
            refuse(
                f"{subject} must point into a memory that {channel.controller.name} reaches, "
                f"not to 0x{start:08X} in {region.name}",
                where,
            )
        if not region.holds(lowest, highest - lowest + 1):
            refuse(
                f"{subject}: what starts at 0x{start:08X} must stay in {region.name}, {_extent(region)}, "
                f"not take {_bytes(lowest, highest)}",
                where,
            )
        for cache in self.cached:
            if lowest < cache.start + cache.nbytes and cache.start <= highest:
                refuse(
                    f"{subject}: what starts at 0x{start:08X} must stay out of {_extent(cache)}, which is cache, "
                    f"not take {_bytes(lowest, highest)}",
                    where,
                )


def check_config(channel: ChannelSpec, config: DmaConfig, direction: Direction, where: str) -> None:
    """Raise MmrError unless `channel` can work with `config` and a peripheral that moves words in `direction`."""
    register = f"{channel.name}_CONFIG"
    config.check_ndsize(register, where)
    if config.WDSIZE.word_bytes > channel.widest_bytes:
        refuse(
            f"{register}: WDSIZE must be {8 * channel.widest_bytes} bits at most, "
            f"not {8 * config.WDSIZE.word_bytes}",
            where,
        )
    if direction is not Direction.EITHER and direction.value != config.WNR:
        does = "writes" if direction is Direction.TO_MEMORY else "reads"
        refuse(
            f"{register}: WNR must be {direction.value}, not {config.WNR:d}: "
            f"the channel {does} memory for {channel.serves}",
            where,
        )


def check_unit(channel: ChannelSpec, unit: WorkUnit, space: DmaSpace, where: str) -> None:
    """Raise MmrError unless each word of `unit` is aligned and in a memory that `channel` reaches."""
    if unit.start_address % unit.word_bytes:
        _refuse_step(channel, "START_ADDR", unit, f"0x{unit.start_address:08X}", where)
    if unit.x_count > 1 and unit.x_modify % unit.word_bytes:
        _refuse_step(channel, "X_MODIFY", unit, str(unit.x_modify), where)
    if unit.y_count > 1 and unit.y_modify % unit.word_bytes:
        _refuse_step(channel, "Y_MODIFY", unit, str(unit.y_modify), where)
    space.check(channel, "START_ADDR", unit.start_address, unit.span, where)


def _refuse_step(channel: ChannelSpec, register: str, unit: WorkUnit, shown: str, where: str) -> NoReturn:
    refuse(
        f"{channel.name}_{register} must be a multiple of {unit.word_bytes} bytes "
        f"with WDSIZE_{8 * unit.word_bytes}, not {shown}",
        where,
    )


def _bytes(lowest: int, highest: int) -> str:
    return f"0x{lowest & 0xFFFF_FFFF:08X}..0x{highest & 0xFFFF_FFFF:08X}"


def _extent(region: Region) -> str:
    return _bytes(region.start, region.start + region.nbytes - 1)
