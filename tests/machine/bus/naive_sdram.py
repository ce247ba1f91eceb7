"""An SDRAM as its data sheet tells it: cycle by cycle, each command as soon as every rule allows it. All times in SCLK."""

from __future__ import annotations

from dataclasses import dataclass, field

from bfsim.chip.spec import SdramSpec

LONG_AGO = -1000


@dataclass
class Bank:
    """One internal bank: the page it has open, and when it last saw a command."""

    page: int | None = None
    activated: int = LONG_AGO
    precharged: int = LONG_AGO
    written: int = LONG_AGO


@dataclass
class NaiveSdram:
    """Words are accessed one after the other; `refresh_every` cycles a refresh is due."""

    spec: SdramSpec
    refresh_every: int
    time: int = 0  # of the next command
    data_end: int = 0
    was_read: bool = False
    due: int = 0
    refreshes: int = 0
    banks: list[Bank] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.due = self.refresh_every
        self.banks = [Bank() for _ in range(self.spec.banks)]

    def access(self, now: int, offset: int, *, write: bool) -> tuple[int, str]:
        """Read or write a word, not before cycle `now`; return the cycle at which its data are through, and its class."""
        self._idle_until(now)
        bank = self.banks[offset // self.spec.bank_bytes]
        page = offset // self.spec.page_bytes
        kind = "hit" if bank.page == page else "miss" if bank.page is None else "conflict"
        if bank.page not in {page, None}:
            while self.time < max(bank.activated + self.spec.nRAS, bank.written + self.spec.nWR):
                self.time += 1
            bank.page, bank.precharged = None, self.time
        if bank.page is None:
            while self.time < bank.precharged + self.spec.nRP:
                self.time += 1
            bank.page, bank.activated = page, self.time
        through = self._transfer(bank, write=write)
        return through, kind

    def _transfer(self, bank: Bank, *, write: bool) -> int:
        """Give the read or write command as soon as the page is open and the data bus will be free."""
        latency = 0 if write else self.spec.nCL
        rest = self.spec.turn_round_sclk if write and self.was_read else 0
        while self.time < bank.activated + self.spec.nRCD or self.time + latency < self.data_end + rest:
            self.time += 1
        self.data_end = self.time + latency + 1
        self.was_read = not write
        if write:
            bank.written = self.data_end
        self.time += 1
        return self.data_end

    def _idle_until(self, now: int) -> None:
        """Let time pass until the controller can begin something new, and refresh whenever that is due."""
        while self.time < now or self.time >= self.due:
            closable = [
                max(each.activated + self.spec.nRAS, each.written + self.spec.nWR)
                for each in self.banks
                if each.page is not None
            ]
            if self.time >= max(self.due, self.data_end, *closable):
                self.due += self.refresh_every
                self.refreshes += 1
                self.time += self.spec.nRP + self.spec.nRAS + self.spec.nRP
                self.banks = [Bank() for _ in self.banks]
            else:
                self.time += 1
