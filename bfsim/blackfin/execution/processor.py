"""A core that runs object code in an address space as native code."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import llvmlite.binding as llvm
import numpy as np
from numpy.typing import NDArray

from bfsim import machine_code
from bfsim.blackfin.execution.address_space import AddressSpace
from bfsim.blackfin.execution.guard import runner
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.instructions.registers import ACCUMULATOR_PARTS, ACCUMULATORS, ASTAT_UNUSED, FLAGS, SLOTS
from bfsim.blackfin.timing.tables import GNU, Timing
from bfsim.blackfin.translation.room import new_counts
from bfsim.blackfin.translation.tracing import Tracing
from bfsim.errors import BfsimError
from bfsim.files import store
from bfsim.machine_code import Effort
from bfsim.machine_code.native_code import native_code

if TYPE_CHECKING:
    from bfsim.blackfin.control_flow.blocks import Code
    from bfsim.blackfin.control_flow.convention import Contract
    from bfsim.blackfin.translation.counters import Counted

NAME = "blackfin"
"""The name of native code; kept code has this and its own name."""
OUTSIDE = 0xFFFFFFFE
"""[ours] The return address of a subroutine that is called from outside: no memory is there, and no code can be."""

COUNT_BYTES = 4
"""Size of the number of counters, which stands before kept machine code."""


class AccessError(BfsimError, LookupError):
    """Raised when code accesses an address where there is no memory."""


class State:
    """The registers, by their names. ASTAT is made of its flags; A0 and A1 are numbers with a sign."""

    def __init__(self) -> None:
        self.slots = np.zeros(len(SLOTS), np.uint64)

    def __getitem__(self, register: str) -> int:
        if register == "ASTAT":
            return sum(self[flag] << place for flag, place in FLAGS.items()) | self["ASTAT_UNUSED"]
        if register == "CYCLES":
            counts = self["SYSCFG"] & 2
            return self["CYCLES_OFFSET"] + (self["CLOCK"] if counts else 0) & 0xFFFFFFFF
        if register in ACCUMULATOR_PARTS:
            return self[register[:2]] >> (32 if register[3] == "X" else 0) & 0xFFFFFFFF
        value = int(self.slots[SLOTS[register]])
        return value - (value >> 63 << 64) if register in ACCUMULATORS else value

    def __setitem__(self, register: str, value: int) -> None:
        if register == "ASTAT":
            self["ASTAT_UNUSED"] = value & ASTAT_UNUSED
            for flag, place in FLAGS.items():
                self[flag] = value >> place & 1
        else:
            self.slots[SLOTS[register]] = value & 0xFFFFFFFFFFFFFFFF


@dataclass
class Translated:
    """Code in this process. `counts`: how often each of its counters has counted since it was translated. `explore`: finds the code.

    `octets`: its object file. `native` owns the code if it lives only as long as this.
    """

    entry: int
    octets: bytes
    native: llvm.ExecutionEngine | None
    counts: NDArray[np.int64]
    explore: Callable[[], Counted]

    @cached_property
    def counted(self) -> Counted:
        """The code that it was made from, and its counters, in the order of the counts."""
        return self.explore()

    @property
    def code(self) -> Code:
        """The code that it was made from."""
        return self.counted.code


@dataclass(slots=True)
class Processor:
    """A core, its registers and its address space.

    `entries`: addresses at which it can be started or that its code computes; others are found when control comes
    there, and the code is translated anew with them. `fuel`: the most blocks that a call of `run` may run, if that is
    limited. `effort`: LLVM's, if it does not depend on the code's size. `name`: the first native code is kept under it,
    so that it need not be made again. `tracing`: how accesses to memory are reported. `explore`: finds the code that
    can be reached from entries, if more than they are needed for that. `contract`: of code that is called as one
    function, from its first address.
    """

    space: AddressSpace
    timing: Timing = GNU
    entries: set[int] = field(default_factory=set)
    fuel: int | None = None
    effort: Effort | None = None
    state: State = field(default_factory=State)
    translated: Translated | None = None
    name: str = ""
    tracing: Tracing | None = None
    explore: Callable[[frozenset[int]], Counted] | None = None
    contract: Contract | None = None

    def prepared(self) -> Translated:
        """Return the native code of all that can be reached from the entries."""
        if self.translated is None:
            self.translated = self._translate()
        return self.translated

    def call(self, address: int) -> Event:
        """Run a subroutine until it returns. Returns the event that it was left for: UNKNOWN_TARGET with PC outside if it returned."""
        self.state["RETS"] = OUTSIDE
        self.state["PC"] = address
        return self.run()

    def run(self) -> Event:
        """Go on at PC until an event that is not a jump to code; code with a contract is left at such jumps, too.

        Raises InstructionError if control comes to something that is not an instruction, and AccessError for an access
        where there is no memory; the registers are then unknown.
        """
        if self.fuel is not None:
            self.state["FUEL"] = self.fuel
        while True:
            start = self.state["PC"]
            if self.translated is None or (start not in self.translated.code.entries and self._is_new(start)):
                self.entries.add(start)
                self.translated = self._translate()
            event = self._enter(self.translated)
            if event is Event.FAULT:
                raise AccessError(
                    f"code must access memory where there is some, but what was started at {start:#010x} accesses "
                    f"{runner().fault.value:#010x}"
                )
            if event is Event.ILLEGAL:
                from bfsim.blackfin.instructions.decode import InstructionError  # few runs decode

                raise InstructionError(self._refusal(self.state["PC"]))
            if event is not Event.UNKNOWN_TARGET or self.state["PC"] == OUTSIDE or self.contract:
                return event

    def _enter(self, translated: Translated) -> Event:
        """Run native code."""
        state, counts = self.state.slots, translated.counts
        return Event(runner().run(translated.entry, self.space.origin, state.ctypes.data, counts.ctypes.data))

    def _is_new(self, address: int) -> bool:
        assert self.translated
        return address not in self.translated.code.targets

    def _translate(self) -> Translated:
        if self.name and self.translated is None:
            return self._kept(self.name)
        found = self.counted()
        octets = native_code(*self._module(found, NAME))
        native = machine_code.loaded(octets)
        counts = new_counts(len(found.counters))
        return Translated(native.get_function_address(NAME), octets, native, counts, lambda: found)

    def _kept(self, name: str) -> Translated:
        """Return the native code that is kept under a name, or make it now; a process loads it once."""
        symbol, kept = f"{NAME}_{name}", store.load(name)
        if kept is None:
            found = self.counted()
            count = len(found.counters).to_bytes(COUNT_BYTES, "little")
            kept = count + machine_code.host_code(*self._module(found, symbol))
            store.save(name, kept)
        octets = kept[COUNT_BYTES:]
        if not machine_code.address_of(symbol):
            machine_code.add(octets)
        counts = new_counts(int.from_bytes(kept[:COUNT_BYTES], "little"))
        return Translated(machine_code.address_of(symbol), octets, None, counts, self.counted)

    def _module(self, found: Counted, symbol: str) -> tuple[str, Effort]:
        """Return the LLVM module of code, whose function is called `symbol`, and LLVM's effort for it."""
        from bfsim.blackfin.translation.translate import (  # most starts find all native code
            is_large,
            is_small,
            translate,
        )

        text = translate(
            found,
            symbol,
            fuel=self.fuel is not None,
            tracing=self.tracing,
            contract=self.contract,
        )
        if self.effort is not None:
            return text, self.effort
        if is_large(found.code):
            return text, Effort.NONE
        return text, Effort.SOME if is_small(found.code) else Effort.SELECTION

    def faulted_at(self) -> list[int]:
        """Return the addresses of the instructions one of which made the last fault; most often there is only one."""
        from bfsim.blackfin.control_flow.blocks import accesses_memory  # few calls fail
        from bfsim.blackfin.translation.host_places import instructions_at

        translated = self.prepared()
        blocks = translated.code.blocks.values()
        accessing = [one.address for each in blocks for one in each.instructions if accesses_memory(one)]
        return instructions_at(translated.octets, runner().place.value - translated.entry, accessing)

    def counted(self) -> Counted:
        """Return all that can be reached from the entries."""
        entries = frozenset(self.entries)
        if self.explore:
            return self.explore(entries)
        from bfsim.blackfin.control_flow.blocks import Code  # what is kept has been explored
        from bfsim.blackfin.translation.counters import Counted

        return Counted(Code(self.space.fetch, entries), self.timing)

    def _refusal(self, address: int) -> str:
        assert self.translated
        blocks = self.translated.code.blocks.values()
        return next(each.refused for each in blocks if each.refused and each.end == address)
