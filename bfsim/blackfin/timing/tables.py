"""What instructions cost: a table for each way to count, by what an instruction does.

`GNU` counts as the GNU simulator does (sim/bfin in GDB 13.1, CYCLE_DELAY): an instruction or a bundle takes a cycle,
those in its table take more. `ADI` counts as Analog Devices documents the pipeline, as far as its documents could be
read: the same cycles, which are those of [EE-197], but a push or pop of several registers takes one for each [EE-171],
and instructions wait for registers.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from bfsim.blackfin.elf.image import Image
from bfsim.blackfin.instructions.registers import DAG, DATA, POINTERS

if TYPE_CHECKING:
    from bfsim.blackfin.instructions.decode import Instruction, Operation

MOVE_SEVERAL = frozenset({"push_multiple", "pop_multiple"})
RANGES = {"d": 8, "p": 6}
"""[PRM] Their operands: the first register that moves, up to R7 and up to P5; these are the numbers after the last ones."""


class Whole(NamedTuple):
    """Code from `first` to `end` whose cycles are known as a whole: `cclk` each time that it is entered."""

    first: int
    end: int
    cclk: int


@dataclass(frozen=True, slots=True)
class Interlock:
    """An instruction that reads one of `registers` right after it was written in one of these ways waits `cclk` cycles.

    `by`: what the writing instruction does. `loaded`: it loaded a word of memory unchanged. `moved_from`: it read one
    of these registers. `used_by`: what the waiting instruction does, if not all wait. `source`: who says so.
    """

    about: str
    registers: frozenset[str]
    cclk: int
    source: str
    by: frozenset[str] = frozenset()
    loaded: bool = False
    moved_from: frozenset[str] = frozenset()
    used_by: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Timing:
    """Core clock cycles of instructions. `cclk`: by what they do, if not 1; for a branch, those if it is not taken.

    `about`: how it counts, in words. `taken_cclk`: of branches that are taken. `each_register`: what takes a cycle for
    each register. `interlocks`: what else instructions wait for. `routines`: cycles of whole functions by their
    symbols, from the first instruction to the return, without callees; `wholes`: where these are in an image.
    """

    name: str
    about: str
    cclk: Mapping[str, int]
    taken_cclk: Mapping[str, int]
    each_register: frozenset[str] = frozenset()
    interlocks: tuple[Interlock, ...] = ()
    routines: Mapping[str, int] = field(default_factory=dict)
    wholes: tuple[Whole, ...] = ()

    def placed(self, image: Image) -> Timing:
        """Return the timing of the code of an image."""
        found = (each for each in image.routines if each.name in self.routines)
        return replace(
            self, wholes=tuple(Whole(each.address, each.end, self.routines[each.name]) for each in found)
        )

    def whole_at(self, address: int) -> Whole | None:
        """Return the code around an address whose cycles are known as a whole, if they are."""
        return next((each for each in self.wholes if each.first <= address < each.end), None)

    def of(self, instruction: Instruction) -> int:
        """Return the cycles of an instruction; for a branch, those if it is not taken."""
        if whole := self.whole_at(instruction.address):
            return whole.cclk if instruction.address == whole.first else 0
        return max(map(self._of, instruction.operations))

    def taken(self, instruction: Instruction) -> int:
        """Return the cycles of a branch that is taken."""
        if self.whole_at(instruction.address):
            return self.of(instruction)
        return self.taken_cclk[instruction.operations[0].form.does]

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all that it says."""
        return hashlib.sha256(json.dumps(asdict(self), default=sorted, sort_keys=True).encode()).hexdigest()

    def _of(self, operation: Operation) -> int:
        does = operation.form.does
        if does in self.each_register:
            return sum(
                behind - int(operation.operands.get(first, behind)) for first, behind in RANGES.items()
            )
        return self.cclk.get(does, 1)


GNU = Timing(
    "gnu",
    "as the GNU simulator counts, without interlocks and memories",
    cclk={
        **dict.fromkeys(
            ("jump", "jump_to", "jump_relative", "call", "call_to", "call_relative", "return_"), 5
        ),
        **dict.fromkeys(
            ("return_from_interrupt", "return_from_exception", "return_from_nmi", "return_from_emulation"), 5
        ),
        "branch": 1,
        "branch_predicted": 9,
        "push_multiple": 14,
        "pop_multiple": 11,
        "link": 3,
        "unlink": 2,
        "multiply_32": 3,
        "test_and_set": 2,
        "core_synchronise": 10,
        "system_synchronise": 10,
        "enable_interrupts": 3,
        "raise_interrupt": 3,
        "exception": 3,
    },
    taken_cclk={"branch": 9, "branch_predicted": 5},
)


ADDRESSES = frozenset((*POINTERS, *DAG))
"""[GCC] ADDRESS_REGNO_P: the registers that addresses are made of."""
ADI = Timing(
    "adi",
    "as Analog Devices documents the pipeline: interlocks, no memories",
    cclk={name: cclk for name, cclk in GNU.cclk.items() if name not in MOVE_SEVERAL},
    taken_cclk=GNU.taken_cclk,
    each_register=MOVE_SEVERAL,  # [EE-171] n registers take n cycles
    interlocks=(
        Interlock(
            "a value loaded into a pointer register",
            ADDRESSES,
            3,
            "[GCC] bfin_adjust_cost, [VANN]",
            loaded=True,
        ),
        Interlock(
            "a value moved from a data to a pointer register",
            ADDRESSES,
            4,
            "[GCC] bfin_adjust_cost, [VANN] of P and I registers",
            by=frozenset({"move", "move_if"}),
            moved_from=frozenset(DATA),
        ),
        Interlock(
            "a return address from the stack",
            frozenset({"RETS"}),
            4,
            "[VANN] of UNLINK; [assumed] of RETS = [SP++], too",
            loaded=True,
            used_by=frozenset({"return_"}),
        ),
    ),
)
