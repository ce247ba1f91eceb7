"""The meaning of boot code's words to the SDRAM controller. Pure functions; fields: Blackfin header defBF561.h."""

from __future__ import annotations

from typing import TypedDict

from bfsim.chip.memory_map import MIB

INTERNAL_BANKS = 4  # of each part in sdram_parts.py


class SdramTiming(TypedDict):
    """The fields of EBIU_SDGCTL that time an access, in SCLK cycles: keyword arguments of SdramSpec."""

    nCL: int
    nRAS: int
    nRP: int
    nRCD: int
    nWR: int


class SdramGeometry(TypedDict):
    """What EBIU_SDBCTL and the width of the data bus say about the parts: keyword arguments of SdramSpec."""

    word_bytes: int
    page_bytes: int
    bank_bytes: int
    banks: int


def sdram_timing_of(sdgctl: int) -> SdramTiming:
    """Return the timing in a word for EBIU_SDGCTL, such as 0x009111CD."""
    return {
        "nCL": sdgctl >> 2 & 0x3,
        "nRAS": sdgctl >> 6 & 0xF,
        "nRP": sdgctl >> 11 & 0x7,
        "nRCD": sdgctl >> 15 & 0x7,
        "nWR": sdgctl >> 19 & 0x3,
    }


def sdram_geometry_of(sdbctl: int, word_bytes: int) -> SdramGeometry:
    """Return the geometry in a word for EBIU_SDBCTL, such as 0x13, on a bus of `word_bytes`."""
    external_bank_bytes = 16 * MIB << (sdbctl >> 1 & 0x7)
    columns = 256 << (sdbctl >> 4 & 0x3)
    return {
        "word_bytes": word_bytes,
        "page_bytes": columns * word_bytes,
        "bank_bytes": external_bank_bytes // INTERNAL_BANKS,
        "banks": INTERNAL_BANKS,
    }
