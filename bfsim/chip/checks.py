"""What must be true of any board, shipped or not: the ranges of its numbers, and how its parts fit each other."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations

from bfsim.chip.memory_map import Region
from bfsim.chip.spec import BoardSpec
from bfsim.errors import ConfigError
from bfsim.fields import leaves, require_types

RANGES: dict[str, tuple[int | Fraction, int | Fraction]] = {
    # fields of EBIU_SDGCTL: see ebiu_registers.py; CL is 2 or 3 of any SDRAM
    "sdram.nCL": (2, 3),
    "sdram.nRCD": (1, 7),
    "sdram.nRP": (1, 7),
    "sdram.nRAS": (1, 15),
    "sdram.nWR": (1, 3),
    "sdram.turn_round_sclk": (0, 1_000),
    "sdram.word_bytes": (2, 4),  # PSM and EBW of EBIU_SDBCTL: a data bus of 16 or 32 bits
    "sdram.banks": (1, 8),  # as many as the model of the SDRAM has
    "chip.l1.conflict_cclk": (0, 1_000),
    "chip.dma.word_bytes": (2, 4),
    "chip.dma.fifo_words": (1, 64),
    "chip.cache.line_bytes": (8, 256),
    "chip.l2.port_bytes": (4, 64),
    "chip.ppi_fifo_words": (1, 4_096),
    "chip.external.store_buffer": (1, 16),  # as many as the model of a core has
    "chip.dma.read_word_sclk": (1, 1_000),
    "chip.dma.on_chip_word_sclk": (Fraction(1, 100), 1_000),
    "deb_period_transfers": (0, 15),  # fields of 4 and 5 bits of DMA_TC_PER
    "mdma_period_transfers": (0, 31),
}
"""Least and greatest value of a field by its path, if they are not those of `SUFFIXES`."""
SUFFIXES: dict[str, tuple[int | Fraction, int | Fraction]] = {
    "_cclk": (0, 100_000),
    "_sclk": (0, 100_000),
    "_hz": (1_000, 10_000_000_000),
    "_ppm": (-100_000, 100_000),
    "phase_frames": (0, 1),
    "settling_frames": (0, 10_000),
    "_256ths": (-256, 256),
    "_levels": (-255, 255),
    "lines_before": (0, 100_000),
    "cache_nbytes": (0, 1 << 31),
    "start": (0, 0xFFFF_FFFF),
}
"""The same by the end of a field's name, the first that fits. [assumed] Far beyond any part, within the model's integers."""
OTHERS = (1, 1 << 31)
LONGEST_RUN_S = 3_600
LATEST_TICK = 1 << 62
FINEST = 1_000_000
"""The greatest denominator of a number that is not a rate in Hz."""
MOST_SUBBANKS = 64
"""The most sub-banks of L1 that the model has."""
MOST_OUTSIDE_L1 = 1 << 28
"""Bytes of SDRAM and L2 together that the model has addresses for."""
POWERS_OF_TWO = (
    "sdram.word_bytes", "sdram.page_bytes", "sdram.bank_bytes", "sdram.banks", "chip.l1.subbank_bytes", "chip.l2.port_bytes",
    "chip.cache.line_bytes", "chip.cache.data_bytes_per_bank", "chip.cache.code_bytes", "chip.dma.word_bytes",
)  # fmt: skip
"""Sizes that are fields of an address."""


def require_sound(board: BoardSpec) -> None:
    """Raise ConfigError, with the path of the field, unless a board is one that can be built and simulated."""
    require_types(board, "board")
    for leaf in leaves(board):
        if isinstance(leaf.value, int | Fraction) and not isinstance(leaf.value, bool):
            _require_range(leaf.path, leaf.value)
    for must_be in (*_clocks(board), *_sdram(board), *_memories(board), *_chip(board), *_cameras(board)):
        raise ConfigError(must_be)


def _require_range(path: str, value: int | Fraction) -> None:
    suffix = next((each for each in SUFFIXES if path.endswith(each)), "")
    least, most = RANGES.get(path) or SUFFIXES.get(suffix) or OTHERS
    if not least <= value <= most:
        raise ConfigError(f"{path} must be {_told(least)} to {_told(most)}, not {_told(value)}")
    if path in POWERS_OF_TWO and int(value).bit_count() != 1:
        raise ConfigError(f"{path} must be a power of two, not {_told(value)}")
    if isinstance(value, Fraction) and value.denominator > FINEST:
        raise ConfigError(
            f"{path} must have a denominator of at most {FINEST:,}, not of {value.denominator:.6g}"
        )


def _told(value: int | Fraction) -> str:
    return f"{float(value):,.12g}"


def _clocks(board: BoardSpec) -> Iterator[str]:
    """Yield what is wrong with the clocks."""
    clocks, chip = board.clocks, board.chip
    if board.pll and chip.clocks_of(board.pll) != clocks:
        yield "clocks must be those that the pll makes; write pll=None for clocks that none makes"
    for name, hz, most in (
        ("cclk_hz", clocks.cclk_hz, "max_vco_hz"),
        ("sclk_hz", clocks.sclk_hz, "max_sclk_hz"),
    ):
        if hz > (most_hz := getattr(chip, most)):
            yield f"clocks.{name} must be at most {_told(most_hz)}, the chip's rating (chip.{most}), not {_told(hz)}"
    if clocks.sclk_hz > clocks.cclk_hz:
        yield f"clocks.sclk_hz must be at most clocks.cclk_hz, {_told(clocks.cclk_hz)}, not {_told(clocks.sclk_hz)}"
    if clocks.tick_hz * LONGEST_RUN_S > LATEST_TICK:
        yield (
            "clocks must have a common multiple of at most "
            f"{LATEST_TICK // LONGEST_RUN_S:.3g} Hz, not {float(clocks.tick_hz):.3g} Hz; give round numbers"
        )


def _sdram(board: BoardSpec) -> Iterator[str]:
    """Yield what is wrong with the SDRAM."""
    sdram = board.sdram
    regions = [each for each in board.chip.regions if each.memory == "SDRAM"]
    if [each.nbytes for each in regions] != [sdram.nbytes]:
        yield (
            f"chip.regions must have one SDRAM of {sdram.nbytes:,} bytes, the banks of sdram; `with_sdram` of "
            "bfsim.chip.memory_map adds it"
        )
    if not sdram.word_bytes <= sdram.page_bytes <= sdram.bank_bytes:
        yield f"sdram.page_bytes must be within sdram.word_bytes and sdram.bank_bytes, not {sdram.page_bytes:,}"
    if board.chip.dma.word_bytes != sdram.word_bytes:
        yield (
            f"chip.dma.word_bytes must be that of the data bus, sdram.word_bytes {sdram.word_bytes}, not "
            f"{board.chip.dma.word_bytes}"
        )
    outside = sum(each.nbytes for each in board.chip.regions if each.memory in ("SDRAM", "L2"))
    if outside > MOST_OUTSIDE_L1:
        yield (
            f"sdram.banks of sdram.bank_bytes must, with the chip's L2, have at most {MOST_OUTSIDE_L1:,} bytes, which is what the "
            f"model has addresses for, not {outside:,}"
        )
    interval_sclk = sdram.refresh_interval_sclk(board.clocks.sclk_hz)
    if interval_sclk <= 2 * sdram.refresh_sclk:
        yield (
            f"sdram.refresh_ms and sdram.rows_refreshed must leave more than {2 * sdram.refresh_sclk} SCLK cycles from one "
            f"refresh to the next, not {interval_sclk}"
        )


def _memories(board: BoardSpec) -> Iterator[str]:
    """Yield what is wrong with the memory map."""
    regions, l1 = board.chip.regions, board.chip.l1
    for one, other in combinations(regions, 2):
        if one.start < other.start + other.nbytes and other.start < one.start + one.nbytes:
            yield f"chip.regions must lie apart, not {one.name} and {other.name} in one place"
    for number, each in enumerate(regions):
        if each.start + each.nbytes > 1 << 32:
            yield f"chip.regions.{number} must end below 0x100000000, not at 0x{each.start + each.nbytes:X}"
        if each.cache_nbytes not in (0, _cache_nbytes(board, each)):
            yield (
                f"chip.regions.{number}.cache_nbytes must be {_cache_nbytes(board, each):,} as chip.cache has it, or 0, "
                f"not {each.cache_nbytes:,}"
            )
        if each.cache_nbytes > each.nbytes:
            yield f"chip.regions.{number}.nbytes must hold its cache of {each.cache_nbytes:,} bytes, not {each.nbytes:,}"
    names = [each.name for each in regions]
    if len(set(names)) != len(names):
        yield "chip.regions must have other names for other memories"
    data = sum(each.nbytes for each in regions if each.memory in ("L1_DATA_A", "L1_DATA_B", "SCRATCH"))
    if data > MOST_SUBBANKS * l1.subbank_bytes:
        yield (
            f"chip.l1.subbank_bytes must make at most {MOST_SUBBANKS} sub-banks of the {data:,} bytes of L1 data, not "
            f"{-(-data // l1.subbank_bytes)}"
        )


def _cache_nbytes(board: BoardSpec, region: Region) -> int:
    cache = board.chip.cache
    return cache.code_bytes if region.memory.startswith("L1_CODE") else cache.data_bytes_per_bank


def _chip(board: BoardSpec) -> Iterator[str]:
    """Yield where the blocks of the chip do not fit each other."""
    chip = board.chip
    interrupts = chip.interrupts.__members__
    if chip.cores not in (("A",), ("A", "B")):
        yield f"chip.cores must be A, or A and B, not {', '.join(chip.cores)}"
    if {each.owner for each in chip.regions} - {*chip.cores, "shared"}:
        yield f"chip.regions must be of the chip's cores, {', '.join(chip.cores)}, or shared"
    if (chip.l2 is not None) != any(each.memory == "L2" for each in chip.regions):
        yield "chip.l2 must be there if chip.regions has an L2, and none if it has not"
    streams = sum(name.startswith("MDMA") for name in interrupts)
    if chip.dma.mdma_streams != streams:
        yield f"chip.dma.mdma_streams must be {streams}, as chip.interrupts has them, not {chip.dma.mdma_streams}"
    if bool(chip.dma.imdma_word_cclk) != ("IMDMA_0" in interrupts):
        yield (
            "chip.dma.imdma_word_cclk must be 1 or more with the internal DMA in chip.interrupts, and 0 without, not "
            f"{chip.dma.imdma_word_cclk}"
        )
    controllers = len({name.split("_")[0] for name in interrupts if name.startswith("MDMA")})
    if chip.dma.controllers != controllers:
        yield f"chip.dma.controllers must be {controllers}, as chip.interrupts has them, not {chip.dma.controllers}"
    cache = chip.cache
    for nbytes, ways, name in (
        (cache.data_bytes_per_bank, cache.data_ways, "data_ways"),
        (cache.code_bytes, cache.code_ways, "code_ways"),
    ):
        if nbytes % (ways * cache.line_bytes):
            yield f"chip.cache.{name} must divide its {nbytes:,} bytes into sets of whole lines of {cache.line_bytes}, not be {ways}"


def _cameras(board: BoardSpec) -> Iterator[str]:
    """Yield what is wrong with the cameras."""
    if not board.chip.ppis == len(board.cameras) == len(board.chip.cores):
        yield (
            f"cameras must be one for each of the chip's PPIs, {board.chip.ppis}, and cores, {len(board.chip.cores)}, not "
            f"{len(board.cameras)}"
        )
    if not board.sensor.modes:
        yield "sensor.modes must be one at least, not none"
    for number, mode in enumerate(board.sensor.modes):
        if mode.line_clocks < mode.active_clocks:
            yield f"sensor.modes.{number}.line_clocks must hold a line's pixels, {mode.active_clocks}, not {mode.line_clocks}"
        if mode.frame_lines <= mode.height_px or mode.lines_before > mode.blank_lines:
            yield (
                f"sensor.modes.{number}.frame_lines must hold the picture, {mode.height_px} lines, and the blank lines, "
                f"{mode.lines_before} before it, not {mode.frame_lines}"
            )
