"""Fields of a register: names, places and widths as the manual has them, and the way between a word and their values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from bfsim.errors import ConfigError


@dataclass(frozen=True, slots=True)
class BitField:
    """`width` bits of a register from bit `low` on."""

    name: str
    low: int
    width: int = 1

    @property
    def largest(self) -> int:
        """The largest value that fits."""
        return (1 << self.width) - 1


@dataclass(frozen=True, slots=True)
class RegisterLayout:
    """The fields of a 16-bit register. Bits of no field are reserved and must be 0."""

    name: str
    fields: tuple[BitField, ...]

    def decode(self, word: int) -> dict[str, int]:
        """Return the value of every field of `word`; raise ConfigError where a reserved bit is set."""
        used = sum(each.largest << each.low for each in self.fields)
        if word & ~used:
            raise ConfigError(
                f"{self.name} must have its reserved bits 0, not 0x{word & ~used:X} (in 0x{word:X})"
            )
        return {each.name: word >> each.low & each.largest for each in self.fields}

    def encode(self, values: Mapping[str, int]) -> int:
        """Return the word with these values, one for each field; raise ConfigError where one does not fit."""
        word = 0
        for each in self.fields:
            value = values[each.name]
            if not 0 <= value <= each.largest:
                raise ConfigError(f"{self.name}.{each.name} must be 0..{each.largest}, not {value}")
            word |= value << each.low
        return word
