"""What instructions cost: a table for each way to count, by what an instruction does.

`GNU` is how the GNU simulator counts (sim/bfin in GDB 13.1, CYCLE_DELAY): an instruction or a bundle takes a cycle, these take more.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from bfsim.blackfin.decode import Instruction
from bfsim.blackfin.interlocks import Interlock


@dataclass(frozen=True, slots=True)
class Timing:
    """Core clock cycles of instructions. `cclk`: by what they do, where it is not 1; of a branch, if it is not taken.

    `about`: how it counts, in words. `taken_cclk`: of branches that are taken. `interlocks`: what else instructions wait for.
    """

    name: str
    about: str
    cclk: Mapping[str, int]
    taken_cclk: Mapping[str, int]
    interlocks: tuple[Interlock, ...] = ()

    def of(self, instruction: Instruction) -> int:
        """Return the cycles of an instruction; if it is a branch, where it is not taken."""
        return max(self.cclk.get(each.form.does, 1) for each in instruction.operations)

    def taken(self, instruction: Instruction) -> int:
        """Return the cycles of a branch that is taken."""
        return self.taken_cclk[instruction.operations[0].form.does]


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
