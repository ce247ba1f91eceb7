"""What is known about a chip, an SDRAM part and a board: frozen records without behaviour.

Numbers carry their unit in the name: `_cclk` and `_sclk` are cycles of the core and system clock, `n*` are
SCLK cycles of the SDRAM controller's own registers (EBIU_SDGCTL).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from bfsim.chip.block_spec import CacheSpec, DmaSpec, EventSpec, ExternalSpec, L1Spec, L2Spec
from bfsim.chip.interrupts import SicInterrupt
from bfsim.chip.memory_map import Region
from bfsim.chip.sensor_spec import CameraSpec, SensorSpec
from bfsim.clocks import Clocks
from bfsim.errors import ConfigError


@dataclass(frozen=True, slots=True, kw_only=True)
class SdramSpec:
    """An SDRAM part as the board's boot code sets its controller up. `word_bytes`: width of the data bus.

    In SCLK cycles, `nCL` pass from a read to its data (CAS latency), `nRCD` from the activation of a row to its first
    access, `nRP` from a precharge to the next activation, `nRAS` at least from an activation to the precharge, `nWR`
    from the last word written to the precharge. `turn_round_sclk` pass between a read and a following write.
    `rows_refreshed` rows are refreshed every `refresh_ms`, one at a time.
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
        """Return the cycles from one refresh to the next: EBIU_SDRRC of u-boot's formula, plus the cycles it leaves out."""
        return int(sclk_hz * self.refresh_ms / (1000 * self.rows_refreshed))


@dataclass(frozen=True, slots=True, kw_only=True)
class Pll:
    """Settings of PLL_CTL and PLL_DIV: VCO = CLKIN x `vco_multiplier`, CCLK = VCO / `csel`, SCLK = VCO / `ssel`.

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
        """The rate that both clocks are divided from."""
        return self.clkin_hz * self.vco_multiplier


@dataclass(frozen=True, slots=True, kw_only=True)
class ChipSpec:
    """A chip: its cores, its memories, its ratings, and the timing of its own blocks. `l2` is None without L2."""

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
class BoardSpec:
    """A board: the chip with the board's memories, how it is clocked, its SDRAM and its cameras.

    `pll` is None if no setting of it makes these `clocks`. `cameras`: those at PPI0, PPI1 and so on. `dma_over_core`:
    CDPRIO of EBIU_AMGCTL, DMA before the cores at the EBIU. `deb_period_transfers` and `mdma_period_transfers`: fields
    of DMA_TC_PER, how many transfers in one direction, and of one MDMA stream, come before the other has its turn; 0
    switches the rule off.
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
