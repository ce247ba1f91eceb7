"""Pointers in index registers, I0-I3: those to half-words that only walk, when all pointer registers that need no saving are taken.

GCC first gives registers to the values that are used most. Saving a register costs a store and a load, an index register
nothing, so it is preferred [assign_hard_reg in ira-color.cc of GCC 12] if it may hold the address: of a half-word, without
an offset [MODE_CODE_BASE_REG_CLASS in bfin.h]. A value loaded by one is not extended by the load [bfin_dsp_memref_p in
extendhisi2 in bfin.md].
"""

from __future__ import annotations

from collections import Counter as Tally
from collections import defaultdict

from bfsim.kernel import operations
from bfsim.kernel.estimate.induction_variables.induction_variable import InductionVariable
from bfsim.kernel.estimate.registers.webs import Webs
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.operations import Op

DATA, INDEX, POINTER = RegisterBank.DATA, RegisterBank.INDEX, RegisterBank.POINTER
HALF_WORDS = {Op.LOAD16, Op.STORE16}
POST_INCREMENT = 2
"""An access uses its pointer, and computes it."""


class IndexRegisters:
    """Puts such pointers of one routine into index registers."""

    def __init__(self, webs: Webs) -> None:
        self.webs, self.context, self.flow, self.code = webs, webs.context, webs.flow, webs.code
        webs.analyse()
        self.points = [(alive, label) for label in self.flow.order for alive in self._points(label)]
        self.walking = {each.name: each for each in self.context.induction_variables.all}

    def place(self) -> None:
        """Assign registers, and extend what is loaded by an index register."""
        taken = [self._counters(label) for _, label in self.points]
        indices = [0] * len(taken)
        able = {web for web in self.walking if self._may_be_index(web)}
        most = operations.SCRATCH_POINTER_REGISTERS
        for web in self._order():
            places = [number for number, (alive, _) in enumerate(self.points) if web in alive]
            is_full = any(taken[number] >= most for number in places)
            has_index = all(indices[number] < operations.INDEX_REGISTERS for number in places)
            if is_full and has_index and web in able:
                self.webs.bank[web] = INDEX
            counts = indices if self.webs.bank[web] is INDEX else taken
            for number in places:
                counts[number] += 1
            most = max([most, *(taken[number] for number in places)])
        rows = [each for block in self.code.of.values() for each in block]
        extended = {name for each in rows if each.op is Op.EXTEND for name, _ in each.uses}
        for label, block in self.code.of.items():
            self.code.of[label] = [row for each in block for row in self._extended(each, extended)]

    def _counters(self, label: str) -> int:
        """Pointer registers that the counters of counted loops take [loop_end in bfin.md]."""
        return sum(loop.header in self.context.counters.counted for loop in self.flow.loops_of(label))

    def _points(self, label: str) -> list[frozenset[str]]:
        """Webs that are alive after and before each instruction of a block."""
        alive = {self.webs.find(name) for name in self.webs.live.out[label]}
        found = [frozenset(alive)]
        for instruction in reversed(self.code.of[label]):
            alive.discard(self.webs.find(instruction.result or ""))
            alive.update(self.webs.find(name) for name, _ in instruction.uses if not name.startswith("#"))
            found.append(frozenset(alive))
        return found

    def _order(self) -> list[str]:
        """Webs in pointer registers, in the order in which they get one: the most used first, of variables the last to start [bucket_allocno_compare_func in ira-color.cc]."""
        used, threads = self._uses(), self._threads()
        of_thread = Tally[str]()
        for web, often in used.items():
            of_thread[threads.get(web) or web] += often
        number = {name: place for place, name in enumerate(self.walking)}
        webs = [web for web, bank in self.webs.bank.items() if bank is POINTER]
        often_used = {web: of_thread[threads.get(web) or web] for web in webs}
        return sorted(webs, key=lambda web: (-often_used[web], -number.get(web, -1), web))

    def _uses(self) -> Tally[str]:
        """How often each web is used or computed, in thousandths; values on the stack are not moved to their register."""
        used = Tally[str]()
        on_stack = self.context.parameters()[operations.REGISTER_ARGUMENTS :]
        for label, block in self.code.of.items():
            weight = int(self.webs.frequency[label] * 1000)
            for instruction in block:
                for name, _ in instruction.uses:
                    variable = self.walking.get(name)
                    steps = variable is not None and _is_stepping(instruction, variable)
                    used[self.webs.find(name)] += weight * (POST_INCREMENT if steps else 1)
                if instruction.result and not any(name in on_stack for name, _ in instruction.uses):
                    used[self.webs.find(instruction.result)] += weight
        return Tally({web: often for web, often in used.items() if web not in on_stack})

    def _threads(self) -> dict[str, str]:
        """For each web, another one that ends where it starts and whose register it gets, or the web that starts that thread [form_threads_from_copies]; for sums of shifted values, which need both there."""
        together = defaultdict[str, set[str]](set)
        for alive, _ in self.points:
            for web in alive:
                together[web] |= alive
        found: dict[str, str] = {}
        for block in self.code.of.values():
            for instruction in (each for each in block if each.op is Op.ADD_SHIFT):
                result = self.webs.find(instruction.result or "")
                for name, _ in reversed(instruction.uses):
                    web = self.webs.find(name)
                    is_pointer = self.webs.bank.get(web) is POINTER is self.webs.bank.get(result)
                    if is_pointer and result not in together[web] and result not in found:
                        found[result] = found.get(web, web)
        return found

    def _may_be_index(self, name: str) -> bool:
        """Whether a variable starts as an array that came in a register, in no loop around, and is used only by its step and accesses to half-words."""
        variable, users = self.walking[name], self._users(name)
        on_stack = self.context.parameters()[operations.REGISTER_ARGUMENTS :]
        return (
            self.webs.bank.get(name) is POINTER
            and variable.steps_free
            and self.context.name(variable.root) not in on_stack
            and not (variable.start or variable.increment.symbolic)
            and self.flow.loops_of(variable.loop.header) == [variable.loop]
            and all(each.op in HALF_WORDS or each.result == name for each in users)
            and all(each.op is Op.MOVE for each in self._users(self.context.name(variable.root)))
            and all(variable.distance_of(each.access) == 0 for each in users if each.access is not None)
            and not any(each.op is Op.CALL for label in variable.loop.blocks for each in self.code.of[label])
        )

    def _users(self, name: str) -> list[MachineInstruction]:
        return [
            each
            for block in self.code.of.values()
            for each in block
            if name in (used for used, _ in each.uses)
        ]

    def _extended(self, each: MachineInstruction, extended: set[str]) -> list[MachineInstruction]:
        """An operation; after a load by an index register its extension, unless a result computed from it is `extended`."""
        by_index = any(self.webs.bank.get(self.webs.find(name)) is INDEX for name, _ in each.uses)
        if not by_index or each.op is not Op.LOAD16 or each.access is None:
            return [each]
        users, value = self._users(each.result or ""), each.result or ""
        if users and all((user.result or "") in extended for user in users):
            return [each]
        if not self.context.narrow.extended_by_load(each.access):
            return [each]
        return [each, MachineInstruction(Op.EXTEND, each.line, value, DATA, ((value, DATA),))]


def _is_stepping(instruction: MachineInstruction, variable: InductionVariable) -> bool:
    """Whether an access is the one with the post-increment of its pointer."""
    stepping = variable.stepping
    return variable.steps_free and stepping is not None and instruction.access is stepping[1]
