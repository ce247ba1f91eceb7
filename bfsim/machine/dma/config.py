"""CONFIG of a DMA channel, decoded and encoded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

from bfsim.chip.dma_registers import (
    CONFIG_FLAGS,
    FLOW_FIELD,
    NDSIZE_FIELD,
    NDSIZE_LIMITS,
    WDSIZE_FIELD,
    Flow,
    WdSize,
)
from bfsim.errors import shown
from bfsim.machine.dma.mmr import check_value, refuse

Code = TypeVar("Code", Flow, WdSize)


@dataclass(frozen=True, slots=True, kw_only=True)
class DmaConfig:
    """CONFIG by its fields, in the manual's spelling. `WNR`: the channel writes memory; `DI_SEL`: interrupt after every row.

    `RESTART` is called SYNC in later manuals.
    """

    DMAEN: bool = True
    WNR: bool = False
    WDSIZE: WdSize = WdSize.WDSIZE_32
    DMA2D: bool = False
    RESTART: bool = False
    DI_SEL: bool = False
    DI_EN: bool = False
    NDSIZE: int = 0
    FLOW: Flow = Flow.STOP

    def __post_init__(self) -> None:
        for kind, code in ((WdSize, self.WDSIZE), (Flow, self.FLOW)):
            if not isinstance(code, kind):  # WDSIZE=16 would set DI_SEL, and move bytes
                known = ", ".join(f"{kind.__name__}.{each.name}" for each in kind)
                refuse(f"CONFIG: {kind.__name__.upper()} must be one of {known}, not {shown(code)}", where="")
        for flag in CONFIG_FLAGS:
            if getattr(self, flag) not in (False, True):
                refuse(f"CONFIG: {flag} must be True or False, not {shown(getattr(self, flag))}", where="")
        check_value("CONFIG: NDSIZE", self.NDSIZE, 0, (1 << NDSIZE_FIELD[1]) - 1, where="")

    def encode(self) -> int:
        """Return the 16 bits of the register."""
        flags: int = sum(getattr(self, flag) << position for flag, position in CONFIG_FLAGS.items())
        fields = ((self.WDSIZE, WDSIZE_FIELD), (self.NDSIZE, NDSIZE_FIELD), (self.FLOW, FLOW_FIELD))
        return flags + sum(value << position for value, (position, _) in fields)

    @classmethod
    def decode(cls, value: int, register: str = "CONFIG", where: str = "") -> DmaConfig:
        """Decode the 16 bits of `register`. Raises MmrError for reserved codes and bits."""
        check_value(register, value, 0, 0xFFFF, where)
        if value >> 15:
            refuse(f"{register}: bit 15 must be 0, not 1 in 0x{value:04X}", where)
        return cls(
            WDSIZE=_code(WdSize, value, WDSIZE_FIELD, f"{register}: WDSIZE", where),
            NDSIZE=_field(value, NDSIZE_FIELD),
            FLOW=_code(Flow, value, FLOW_FIELD, f"{register}: FLOW", where),
            **{flag: bool(value >> position & 1) for flag, position in CONFIG_FLAGS.items()},
        )

    def check_ndsize(self, register: str, where: str) -> None:
        """Raise MmrError unless NDSIZE is valid for FLOW."""
        least, most = NDSIZE_LIMITS[self.FLOW]
        if not least <= self.NDSIZE <= most:
            sizes = f"{least}..{most}" if most else "0"
            refuse(f"{register}: FLOW={self.FLOW.name} requires NDSIZE {sizes}, not {self.NDSIZE}", where)


def _field(value: int, field: tuple[int, int]) -> int:
    position, bits = field
    return value >> position & (1 << bits) - 1


def _code(kind: type[Code], value: int, field: tuple[int, int], name: str, where: str) -> Code:
    code = _field(value, field)
    try:
        return kind(code)
    except ValueError:
        known = ", ".join(f"{each.value} ({each.name})" for each in kind)
        refuse(f"{name} must be {known}, not the reserved {code}", where)
