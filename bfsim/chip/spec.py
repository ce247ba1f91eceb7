"""What is known about a chip, an SDRAM part, a sensor and a board: frozen records without behaviour.

Numbers carry their unit in the name: `_cclk` and `_sclk` are cycles of the core and system clock, `n*` are
SCLK cycles of the SDRAM controller's own registers (EBIU_SDGCTL).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from bfsim.chip.interrupts import SicInterrupt
from bfsim.chip.memory_map import Region
from bfsim.clocks import Clocks
from bfsim.errors import ConfigError


@dataclass(frozen=True, slots=True, kw_only=True)
class SdramSpec:
    """An SDRAM part as the board's boot code sets its controller up. `word_bytes`: width of the data bus.

    In SCLK cycles, `nCL` pass from a read to its data (CAS latency), `nRCD` from the activation of a row to its first access, `nRP` from
    a precharge to the next activation, `nRAS` at least from an activation to the precharge, `nWR` from the last word written to it.
    `turn_round_sclk` pass between a read and a write behind it. `rows_refreshed` rows are refreshed every `refresh_ms`, one at a time.
    """

    part: str
    nCL: int
    nRCD: int
    nRP: int
    nRAS: int
    nWR: int
    turn_round_sclk: int
    refresh_ms: int
    rows_refreshed: int
    word_bytes: int
    page_bytes: int
    bank_bytes: int
    banks: int

    @property
    def nbytes(self) -> int:
        """Size of all banks."""
        return self.banks * self.bank_bytes

    @property
    def miss_sclk(self) -> int:
        """Extra cycles when the bank is closed: activate."""
        return self.nRCD

    @property
    def conflict_sclk(self) -> int:
        """Extra cycles when another page is open: precharge, then activate."""
        return self.nRP + self.nRCD

    @property
    def refresh_sclk(self) -> int:
        """Cycles of one refresh: precharge all banks, refresh a row, and precharge it."""
        return self.nRP + self.nRAS + self.nRP

    def refresh_interval_sclk(self, sclk_hz: Fraction) -> int:
        """Cycles from one refresh to the next: EBIU_SDRRC of u-boot's formula, plus the cycles it leaves out."""
        return int(sclk_hz * self.refresh_ms / (1000 * self.rows_refreshed))


@dataclass(frozen=True, slots=True, kw_only=True)
class L1Spec:
    """L1 data memory: `subbank_bytes` that take one access a cycle. `conflict_cclk`: what the second one waits."""

    subbank_bytes: int
    conflict_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CacheSpec:
    """A cache in L1: what it takes of each memory that can be cache, and how it is divided.

    `invalidate_cclk`: what the loop that invalidates lines of the data cache takes for each.
    """

    line_bytes: int
    data_ways: int
    data_bytes_per_bank: int
    code_ways: int
    code_bytes: int
    invalidate_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class L2Spec:
    """Shared L2: latency of a core's read, and how long each 64 bits hold the port that both cores share."""

    read_cclk: int
    next_cclk: int
    port_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ExternalSpec:
    """A core's way to SDRAM through the EBIU.

    `core_sync_sclk`: what a read takes beside the SDRAM's own cycles, to the bus and back; a store is posted
    into a buffer of `store_buffer` words.
    """

    core_sync_sclk: int
    store_buffer: int


@dataclass(frozen=True, slots=True, kw_only=True)
class DmaSpec:
    """The DMA controllers. A work unit starts in `startup_sclk`; a descriptor costs `descriptor_sclk` an element, beside its memory.

    `word_bytes`: width of their buses, and the longest word; `mdma_streams`: memory DMA, of all controllers together.
    `read_word_sclk`: memory DMA, cycles per word from SDRAM on an open page (to SDRAM it is one);
    `on_chip_word_sclk`: between L1 and L2; `imdma_word_cclk`: the internal DMA, 0 without one.
    """

    controllers: int
    mdma_streams: int
    word_bytes: int
    fifo_words: int
    startup_sclk: int
    descriptor_sclk: int
    read_word_sclk: Fraction
    on_chip_word_sclk: Fraction
    imdma_word_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class EventSpec:
    """Interrupts, registers and locks. Entry: from the request to the handler's first line; exit: the way back.

    `mmr_*_cclk`: an access to a register of a device. `testset_cclk`: TESTSET without its memory; `spin_cclk`: a turn
    of a spin loop without its TESTSET.
    """

    interrupt_entry_cclk: int
    interrupt_exit_cclk: int
    mmr_read_cclk: int
    mmr_write_cclk: int
    testset_cclk: int
    spin_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Pll:
    """How PLL_CTL and PLL_DIV are set: VCO = CLKIN x `vco_multiplier`, CCLK = VCO / `csel`, SCLK = VCO / `ssel`.

    Raises ConfigError for what the fields of the registers cannot hold.
    """

    clkin_hz: Fraction
    vco_multiplier: int
    csel: int
    ssel: int

    def __post_init__(self) -> None:
        # ranges: comments on CONFIG_VCO_MULT, CCLK_DIV and SCLK_DIV in u-boot's include/configs/cm-bf561.h
        if not 1 <= self.vco_multiplier <= 64:
            raise ConfigError(f"vco_multiplier must be 1 to 64, not {self.vco_multiplier}")
        if self.csel not in (1, 2, 4, 8):
            raise ConfigError(f"csel must be 1, 2, 4 or 8, not {self.csel}")
        if not 1 <= self.ssel <= 15:
            raise ConfigError(f"ssel must be 1 to 15, not {self.ssel}")

    @property
    def vco_hz(self) -> Fraction:
        """What both clocks are divided from."""
        return self.clkin_hz * self.vco_multiplier


@dataclass(frozen=True, slots=True, kw_only=True)
class ChipSpec:
    """A chip: its cores, its memories, its ratings, and the timing of its own blocks. Without L2 `l2` is None."""

    name: str
    cores: tuple[str, ...]
    ppis: int
    max_vco_hz: Fraction
    max_sclk_hz: Fraction
    regions: tuple[Region, ...]
    l1: L1Spec
    cache: CacheSpec
    l2: L2Spec | None
    external: ExternalSpec
    dma: DmaSpec
    ppi_fifo_words: int
    events: EventSpec
    interrupts: type[SicInterrupt]

    def clocks_of(self, pll: Pll) -> Clocks:
        """Return the clocks that `pll` makes; raise ConfigError if the chip is not rated for them."""
        clocks = Clocks(cclk_hz=pll.vco_hz / pll.csel, sclk_hz=pll.vco_hz / pll.ssel)
        for name, hz, most_hz in (
            ("VCO", pll.vco_hz, self.max_vco_hz),
            ("SCLK", clocks.sclk_hz, self.max_sclk_hz),
        ):
            if hz > most_hz:
                raise ConfigError(
                    f"{name} of an {self.name} must be at most {float(most_hz):,.0f} Hz, not {float(hz):,.0f} Hz "
                    f"(CLKIN x {pll.vco_multiplier}, csel {pll.csel}, ssel {pll.ssel})"
                )
        return clocks


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorMode:
    """One picture size of a sensor, in PPI_CLK cycles and in lines; two cycles carry one UYVY pixel.

    A line is `line_clocks` cycles, its pixels first and its blanking behind them (HREF, the line sync, rises
    with the first pixel). A frame is `frame_lines` lines: `lines_before` blank ones from the frame sync on,
    the picture, and the blank rest.
    """

    width_px: int
    height_px: int
    ppi_clk_hz: Fraction
    line_clocks: int
    frame_lines: int
    lines_before: int

    @property
    def active_clocks(self) -> int:
        """PPI_CLK cycles of a line that carry pixels."""
        return 2 * self.width_px

    @property
    def blank_lines(self) -> int:
        """Lines of a frame without a picture: the vertical blanking."""
        return self.frame_lines - self.height_px

    @property
    def frame_clocks(self) -> int:
        """PPI_CLK cycles of a frame."""
        return self.line_clocks * self.frame_lines

    @property
    def frame_hz(self) -> Fraction:
        """Frames per second."""
        return self.ppi_clk_hz / self.frame_clocks


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
        return SensorMode(
            width_px=width_px,
            height_px=height_px,
            ppi_clk_hz=full.frame_hz * line_clocks * frame_lines,
            line_clocks=line_clocks,
            frame_lines=frame_lines,
            lines_before=full.lines_before * (frame_lines - height_px) // full.blank_lines,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraSpec:
    """What is a camera's own, beside the sensor in it: its oscillator, and how it settles after new settings.

    The oscillator runs `offset_ppm` millionths fast (below 0: slow), and its first frame sync comes
    `phase_frames` (0 to 1) of a frame after the board's start. After a change of its settings the next
    `settling_frames` pictures are off: for each frame left to go they are `y_step_256ths` / 256 too bright, and
    their U and V differ by `u_step_levels` and `v_step_levels`.
    """

    name: str
    offset_ppm: Fraction
    phase_frames: Fraction
    settling_frames: int
    y_step_256ths: int
    u_step_levels: int
    v_step_levels: int


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardSpec:
    """A board: the chip with the board's memories, how it is clocked, its SDRAM and its cameras.

    `pll` is None where no setting of it makes these `clocks`. `cameras`: what PPI0, PPI1 and so on look at.
    `dma_over_core`: CDPRIO of EBIU_AMGCTL, DMA before the cores at the EBIU. `deb_period_transfers` and
    `mdma_period_transfers`: fields of DMA_TC_PER, transfers in one direction, and of one MDMA stream, before the other
    has its turn; 0 switches the rule off.
    """

    name: str
    title: str
    chip: ChipSpec
    pll: Pll | None
    clocks: Clocks
    sdram: SdramSpec
    sensor: SensorSpec
    cameras: tuple[CameraSpec, ...]
    dma_over_core: bool
    deb_period_transfers: int = 0
    mdma_period_transfers: int = 0
    spi_clk_hz: Fraction
