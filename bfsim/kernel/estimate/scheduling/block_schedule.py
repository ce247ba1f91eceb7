"""The order in which the instructions of one block are issued, and the accesses that share a bundle with a 32-bit instruction.

GCC 12 schedules each block after register allocation, and bundles what it issues in one cycle [bfin_reorg and
bfin_gen_bundles in bfin.cc]: a DSP instruction, then an access of 16 bits of code, whose units are free only if the DSP
instruction came first [`absence_set` in bfin.md]. All other instructions are issued alone. For this, a move between
data registers and a zero are DSP instructions, too [`splitting_for_sched`], and so is a shift whose operand is still
needed.
"""

from __future__ import annotations

from collections import Counter as Tally
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping

from bfsim.kernel.estimate.scheduling.local_registers import LocalRegisters, copies_for, used
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.operations import (
    BARRIERS,
    COSTS,
    LOAD_TO_POINTER_STALL,
    LOADS,
    MOVE_TO_POINTER_STALL,
    STORES,
    TESTS,
    Op,
)

WIDE = {Op.DSP_ALU, Op.MUL16, Op.MAC}
SHORT_BYTES = 2
CHANGES_CC = {Op.COMPARE, Op.BIT_TEST}
KINDS = {"barrier": BARRIERS, "store": STORES, "access": LOADS | STORES, "test": TESTS}
WAITING = {"barrier": {*Op}, "store": LOADS, "access": STORES, "test": TESTS}
"""The kinds of instructions that wait for those of a kind."""

_Reason = tuple[str, str]
"""A relation between instructions: a kind, or a value or register and its name."""


class BlockSchedule:
    """The schedule of one block: the instruction with the longest path to the end is issued first.

    `renews`: the phi whose next value each value becomes.
    """

    def __init__(self, registers: LocalRegisters, renews: Mapping[str, str]) -> None:
        self.registers, self.renews = registers, renews
        self.instructions, self.bank_of = registers.instructions, registers.bank_of
        self.registers_are_enough = registers.are_enough
        self.behind: list[dict[int, int]] = [{} for _ in self.instructions]
        """For each instruction: those that wait for it, and for how many cycles."""
        met = defaultdict[_Reason, list[int]](list)
        for then, each in enumerate(self.instructions):
            # in a long block these are few; looking at every pair would take most of the time
            related = {*range(then)[-1:]}.union(*(met.get(reason, ()) for reason in self._asks(then)))
            for first in range(then) if each.op in BARRIERS else related:
                gap = self._gap(first, then)
                if gap is not None:
                    self.behind[first][then] = gap
            for reason in self._offers(then):
                met[reason].append(then)
        self.priority = [0] * len(self.instructions)
        for number in reversed(range(len(self.instructions))):
            paths = (gap + self.priority[then] for then, gap in self.behind[number].items())
            self.priority[number] = max(paths, default=1)

    def paired(self) -> frozenset[tuple[int, int]]:
        """Return the positions of 32-bit instructions and of the accesses that are issued with them."""
        before = Tally(then for each in self.behind for then in each)
        earliest = [0] * len(self.instructions)
        ready = {number for number in range(len(self.instructions)) if not before[number]}
        found, now = set[tuple[int, int]](), 0

        def issue(among: Callable[[int], bool]) -> int | None:
            able = (each for each in ready if earliest[each] <= now and among(each))
            number = min(able, key=self._rank, default=None)
            if number is not None:
                ready.remove(number)
                for then, gap in self.behind[number].items():
                    before[then] -= 1
                    earliest[then] = max(earliest[then], now + gap)
                    if not before[then]:
                        ready.add(then)
            return number

        while ready:
            first = issue(lambda _: True)
            second = issue(self._is_short_access) if first is not None and self._is_wide(first) else None
            if first is not None and second is not None:
                found.add((first, second))
            now += 1
        return frozenset(found)

    def _rank(self, number: int) -> tuple[int, int, int]:
        return -self.priority[number], -len(self.behind[number]), number

    def _is_wide(self, number: int) -> bool:
        each = self.instructions[number]
        if each.op in WIDE:
            return True
        if not self.registers_are_enough:
            return False
        data = each.result is not None and self.bank_of(each.result) is RegisterBank.DATA
        if each.op is Op.IMM:
            return data and [name for name, _ in each.uses] == ["#0"]
        if each.op is Op.MOVE:
            sources = used(self.instructions, number)
            is_data = data or is_kept(each) or copies_for(each, self.instructions[number + 1 : number + 2])
            return is_data and all(self.bank_of(name) is RegisterBank.DATA for name in sources)
        return (
            each.op is Op.SHIFT
            and data
            and len(each.uses) == 1
            and self.registers.written[number] not in self.registers.read[number]
        )

    def _is_short_access(self, number: int) -> bool:
        each = self.instructions[number]
        is_reload = each.op in LOADS and each.result is None
        return each.op in LOADS | STORES and each.code_bytes == SHORT_BYTES and not is_reload

    def _offers(self, first: int) -> Iterator[_Reason]:
        """The reasons for which a later instruction may wait for this one: its kind, what it computes, reads, writes and keeps."""
        each, registers = self.instructions[first], self.registers
        yield from ((kind, "") for kind, ops in KINDS.items() if each.op in ops)
        yield from (("register", name) for name in {*registers.read[first], registers.written[first]} if name)
        if result := registers.results[first]:
            yield "value", result
        if is_kept(each):
            yield "kept", each.uses[0][0]

    def _asks(self, then: int) -> Iterator[_Reason]:
        """The reasons for which this instruction may wait for an earlier one that is not right before it, unless it is a barrier."""
        each, registers = self.instructions[then], self.registers
        yield from ((kind, "") for kind, ops in WAITING.items() if each.op in ops)
        yield from (("value", name) for name in registers.uses[then])
        if written := registers.written[then]:
            yield "register", written
        if renewed := self.renews.get(each.result or ""):
            yield "kept", renewed

    def _gap(self, first: int, then: int) -> int | None:
        """The least number of cycles from the issue of `first` to the issue of `then`; None if they are independent."""
        one, other = self.instructions[first], self.instructions[then]
        if {one.op, other.op} & BARRIERS:
            return 1
        result = self.registers.results[first]
        if result is not None and result in self.registers.uses[then]:
            return self._latency(one)
        if then == first + 1 and copies_for(one, [other]):
            return 1
        if is_kept(one) and self.renews.get(other.result or "") == one.uses[0][0]:
            return 0
        if one.op in CHANGES_CC and other.op in TESTS - CHANGES_CC:
            return 1
        if one.op in STORES and other.op in LOADS:
            return 1
        written = self.registers.written[then]
        if written is not None and (
            written == self.registers.written[first] or written in self.registers.read[first]
        ):
            return 0
        if (one.op in TESTS and other.op in TESTS) or (one.op in LOADS | STORES and other.op in STORES):
            return 0
        return None

    def _latency(self, first: MachineInstruction) -> int:
        cclk = COSTS[first.op].cclk if first.cclk is None else first.cclk
        if self.bank_of(first.result or "") is not RegisterBank.POINTER:
            return cclk
        if first.op in LOADS:
            return cclk + LOAD_TO_POINTER_STALL
        from_data = first.op is Op.MOVE and any(
            self.bank_of(name) is RegisterBank.DATA for name, _ in first.uses
        )
        return cclk + (MOVE_TO_POINTER_STALL if from_data else 0)


def is_kept(each: MachineInstruction) -> bool:
    """Whether an instruction copies the old value of a loop's variable before the new one is computed."""
    return each.op is Op.MOVE and each.result is None and bool(each.uses)
