"""SDRAM by its rules, in plain Python: the earliest tick of everything that can happen.

Written independently of the compiled `sdram.py`, from the same data: the two must agree. Commands are issued in order, one per
cycle. A precharge or an activation delays the next access, whatever its bank.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from bfsim.chip.spec import SdramSpec
from bfsim.clocks import Clocks


class Page(IntEnum):
    """What an access finds: its page open, its bank closed, or another page open in the bank."""

    HIT = 0
    MISS = 1
    CONFLICT = 2


@dataclass(frozen=True, slots=True)
class Access:
    """An access as it would go: ticks of its activation (none on a hit), of its command, and of the end of its data."""

    page: Page
    activated: int
    command: int
    through: int


@dataclass(slots=True)
class SdramBank:
    """One internal bank. Its open page may be closed from tick `precharge_from` on."""

    is_open: bool = False
    page: int = 0
    precharge_from: int = 0


class SdramBanks:
    """The banks and the controller of a board's SDRAM."""

    def __init__(self, sdram: SdramSpec, clocks: Clocks) -> None:
        self._spec = sdram
        self._sclk = clocks.sclk_ticks
        self._interval = sdram.refresh_interval_sclk(clocks.sclk_hz) * self._sclk
        self._banks = [SdramBank() for _ in range(sdram.banks)]
        self.command_from = 0
        """Earliest tick of the next command."""
        self._data_from = 0
        self._wrote = False
        self.refresh_due = self._interval
        """Tick of the next refresh."""

    def probe(self, now: int, offset: int, *, write: bool) -> Access:
        """Return how an access to `offset`, requested at tick `now`, would go."""
        spec, sclk = self._spec, self._sclk
        bank, page = self._banks[offset // spec.bank_bytes], offset // spec.page_bytes
        found, activated = Page.HIT, 0
        command = max(now, self.command_from)
        if not bank.is_open or bank.page != page:
            found, activated = Page.MISS, command
            if bank.is_open:
                found, activated = Page.CONFLICT, max(command, bank.precharge_from) + spec.nRP * sclk
            command = activated + spec.nRCD * sclk
        if write:
            turn = 0 if self._wrote else spec.turn_round_sclk * sclk
            command = max(command, self._data_from + turn)
            return Access(found, activated, command, command + sclk)
        command = max(command, self._data_from - spec.nCL * sclk)
        return Access(found, activated, command, command + (spec.nCL + 1) * sclk)

    def issue(self, now: int, offset: int, *, write: bool, beats: int) -> Access:
        """Make an access of `beats` words of the data bus, one cycle each. Return how the first one went."""
        spec, sclk = self._spec, self._sclk
        access = self.probe(now, offset, write=write)
        bank = self._banks[offset // spec.bank_bytes]
        more = (beats - 1) * sclk
        if access.page is not Page.HIT:
            bank.is_open, bank.page = True, offset // spec.page_bytes
            bank.precharge_from = access.activated + spec.nRAS * sclk
        if write:
            written = access.through + more + spec.nWR * sclk
            bank.precharge_from = max(bank.precharge_from, written)
        self.command_from = access.command + sclk + more
        self._data_from = access.through + more
        self._wrote = write
        return access

    def refresh(self) -> None:
        """Refresh as soon as it is due, earlier data are through and every bank can be closed."""
        closing = (bank.precharge_from for bank in self._banks if bank.is_open)
        begin = max(self.refresh_due, self.command_from, self._data_from, *closing)
        for bank in self._banks:
            bank.is_open = False
        self.command_from = begin + self._spec.refresh_sclk * self._sclk
        self.refresh_due += self._interval
