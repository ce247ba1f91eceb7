"""What is known about a chip, an SDRAM part, a sensor and a board: frozen records without behaviour.

Numbers carry their unit in the name: `_cclk` and `_sclk` are cycles of the core and system clock, `n*` are
SCLK cycles of the SDRAM controller's own registers (EBIU_SDGCTL).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from bfsim.chip.memory_map import Region
from bfsim.clocks import Clocks


@dataclass(frozen=True, slots=True, kw_only=True)
class SdramSpec:
    """An SDRAM part as the board's boot code sets its controller up."""

    part: str
    nCL: int
    nRCD: int
    nRP: int
    word_bytes: int
    page_bytes: int
    bank_bytes: int
    banks: int

    @property
    def miss_sclk(self) -> int:
        """Extra cycles when the bank is closed: activate."""
        return self.nRCD

    @property
    def conflict_sclk(self) -> int:
        """Extra cycles when another page is open: precharge, then activate."""
        return self.nRP + self.nRCD


@dataclass(frozen=True, slots=True, kw_only=True)
class ChipSpec:
    """Timing of the chip's own blocks.

    `core_sdram_read_sclk`: an uncached 32-bit read of an open page, as the core sees it. A store is posted and
    holds the bus for `core_sdram_write_sclk`. `mdma_read_sclk` and `mdma_write_sclk`: cycles per 32-bit word of
    a memory DMA from and to SDRAM on an open page; `mdma_startup_sclk`: one work unit's start.
    """

    name: str
    cores: tuple[str, ...]
    regions: tuple[Region, ...]
    l2_read_cclk: int
    core_sdram_read_sclk: int
    core_sdram_write_sclk: int
    mdma_startup_sclk: int
    mdma_read_sclk: Fraction
    mdma_write_sclk: Fraction
    ppi_word_sclk: Fraction
    semaphore_issue_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorMode:
    """One picture size of a sensor. A line is `line_clocks` PPI_CLK cycles, blanking included; a frame `frame_lines`."""

    width_px: int
    height_px: int
    ppi_clk_hz: Fraction
    line_clocks: int
    frame_lines: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorSpec:
    """A camera with a UYVY output of two PPI_CLK cycles a pixel."""

    name: str
    modes: tuple[SensorMode, ...]

    def mode(self, width_px: int, height_px: int) -> SensorMode:
        """Return the mode of that size.

        A size that the sensor does not have is timed like its largest mode: the same blanking in proportion, and
        the same frame rate. That is an assumption for pictures of other cameras, not a property of the sensor.
        """
        for each in self.modes:
            if (each.width_px, each.height_px) == (width_px, height_px):
                return each
        full = max(self.modes, key=lambda each: each.width_px)
        line_clocks = -(-full.line_clocks * width_px // full.width_px)
        frame_lines = -(-full.frame_lines * height_px // full.height_px)
        frames_hz = full.ppi_clk_hz / (full.line_clocks * full.frame_lines)
        return SensorMode(
            width_px=width_px,
            height_px=height_px,
            ppi_clk_hz=frames_hz * line_clocks * frame_lines,
            line_clocks=line_clocks,
            frame_lines=frame_lines,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardSpec:
    """A board: the chip, how it is clocked, its SDRAM and its cameras."""

    name: str
    title: str
    chip: ChipSpec
    clocks: Clocks
    sdram: SdramSpec
    sensor: SensorSpec
