"""Induction variables: pointers that a loop steps along, each with the array accesses that share it."""

from __future__ import annotations

from bfsim.kernel import operations
from bfsim.kernel.estimate.induction_variables.induction_variable import InductionVariable
from bfsim.kernel.estimate.induction_variables.kept_addresses import Access, keeps_address, stepping_access
from bfsim.kernel.estimate.induction_variables.shared_pointers import is_steady, share_pointers
from bfsim.kernel.estimate.loops.scalar_evolution import Affine, ScalarEvolution
from bfsim.kernel.ir.control_flow import EITHER, ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, arms_of, each_arm, is_number
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule

COUNTING = ("getelementptr", "icmp", "phi", "br")
"""Uses of a counter as an address, for the end of a loop, or for the next iteration."""
SUMS = ("add", "sub")
HIDDEN = ".len"  # every array comes with its length, which C code would not pass


class InductionVariables:
    """The induction variables of one routine; `of` finds that of an access by its identity."""

    def __init__(self, flow: ControlFlow, evolution: ScalarEvolution, profile: CompilerProfile) -> None:
        self.flow, self.evolution, self.profile = flow, evolution, profile
        self.all: list[InductionVariable] = []
        self.of: dict[int, InductionVariable] = {}
        found: dict[tuple[str, tuple[tuple[str, int], ...]], InductionVariable] = {}
        for label in flow.order:
            for each in flow.blocks[label].instructions:
                if each.opcode in ("load", "store"):
                    for where, pointer in self._pointers(label, each):
                        self._place(where, each, pointer, found)
        for variable in self.all:
            variable.stepping = stepping_access(variable.accesses, variable.loop, evolution)
            variable.steps_free = self._steps_free(variable)
            keeps = variable.steps_free and profile.applies(Rule.KEPT_ADDRESSES)
            variable.keeps_address = keeps and keeps_address(
                variable.accesses, variable.stepping, variable.loop, flow
            )
            variable.offset_apart = not any(offset == 0 for _, _, offset in variable.accesses)
        indexed = [each for each in self.all if self._is_indexed(each)]
        self.all = [each for each in self.all if each not in indexed]
        self.of = {access: each for access, each in self.of.items() if each not in indexed}
        share_pointers(self.all, flow, evolution)

    def _is_indexed(self, variable: InductionVariable) -> bool:
        """Whether a byte is accessed by a counter that every iteration needs anyway: its address costs less than stepping a pointer.

        [determine_group_iv_cost_address: six, and one for the array's register; for a pointer one, five for its step, and two for its register]
        """
        if variable.steps_free or variable.increment.symbolic or len(variable.accesses) > 1:
            return False
        if variable.accesses[0][1].bits != operations.BYTE_BITS:
            return False
        loop, terms = variable.loop, self.evolution.affine(variable.accesses[0][1].operands[-1]).terms
        counters = [name for name, times in terms if times == 1]
        return any(
            self.flow.defined.get(each, ("",))[0] == loop.header and self._stays(each, loop)
            for each in counters
        )

    def _stays(self, counter: str, loop: Loop) -> bool:
        """Whether a counter of `loop` is used in each iteration or after the loop, or no pointer can end the loop for it without a division."""
        increment = self.evolution.increment(counter, loop)
        test = self.flow.instruction(self.evolution.exit_test(loop) or "")
        if increment is None or test is None:
            return False
        steps = {
            each.result
            for each in self.flow.users[counter]
            if each.opcode == "add" and self.evolution.increment(each.result or "", loop) is not None
        }
        names = {counter, *steps}
        divides = abs(increment.constant).bit_count() > 1 and not is_number(test.operands[1])
        if divides and test.operands[0] in names:
            return True
        return any(
            names & {*each.operands}
            and (label not in loop.blocks or (each.result not in names and not self._is_address(each)))
            for label, block in self.flow.blocks.items()
            if label not in loop.blocks or self.flow.every_iteration(label, loop)
            for each in block.instructions
        )

    def _is_address(self, each: Instruction) -> bool:
        """Whether something is an address, the end of a loop or for the next iteration; or a sum of which nothing but addresses are made."""
        users = self.flow.users.get(each.result or "", [])
        made = (
            user.opcode == "getelementptr" or (user.opcode in SUMS and self._is_address(user))
            for user in users
        )
        return each.opcode in COUNTING or (each.opcode in SUMS and bool(users) and all(made))

    def is_steady(self, variable: InductionVariable) -> bool:
        """Whether every iteration makes one of the accesses."""
        return is_steady(self.flow, variable)

    def _pointers(self, label: str, each: Instruction) -> list[tuple[str, str]]:
        """(block, pointer) of an access; LLVM merges the loads of several arms, a compiler for the Blackfin does not."""
        source = self.flow.instruction(each.operands[-1])
        if source is not None and is_merged_pointer(source) and self.profile.applies(Rule.MERGED_LOADS):
            return [(arm_label, value) for value, arm_label in each_arm(source)]
        return [(label, each.operands[-1])]

    def _place(
        self,
        label: str,
        each: Instruction,
        pointer: str,
        found: dict[tuple[str, tuple[tuple[str, int], ...]], InductionVariable],
    ) -> None:
        for loop in self.flow.loops_of(label):
            increment = self.evolution.increment(pointer, loop)
            if increment is None:
                return
            if increment.moves:
                affine = self.evolution.affine(pointer)
                key = (loop.header, affine.terms)
                variable = found.get(key)
                if variable is None:
                    root = self._root(affine)
                    variable = found[key] = InductionVariable(
                        f"%walk.{len(self.all)}", loop, root, increment, each.line
                    )
                    variable.start = self._start(affine, root, loop)
                    self.all.append(variable)
                variable.accesses.append(Access(label, each, affine.constant))
                self.of[id(each)] = variable
                return

    def _root(self, affine: Affine) -> str:
        """The array that an address points into: a parameter with a length, or else a term that counts once."""
        once = [name for name, times in affine.terms if times == 1]
        arrays = [name for name in once if f"{name}{HIDDEN}" in self.flow.routine.parameters]
        return next(iter((*arrays, *once)), affine.terms[0][0])

    def _start(self, affine: Affine, root: str, loop: Loop) -> tuple[tuple[str, int], ...]:
        """The terms of the first address that the loop around does not step along."""
        around = self.flow.around(loop)
        if around is None:
            return ()
        terms = [(self._entering_value(name, loop), times) for name, times in affine.terms if name != root]
        return tuple(
            (name, times)
            for name, times in terms
            if not is_number(name)
            and self.evolution.code_motion.is_invariant(name, loop)
            and self.evolution.increment(name, around) is None
            and not self._is_carried(name, around)
        )

    def _is_carried(self, name: str, around: Loop, depth: int = 4) -> bool:
        """Whether the loop around carries a position that only some iterations, or inner loops, step."""
        each = self.flow.instruction(name)
        if each is None or depth == 0 or self.flow.defined[name][0] not in around.blocks:
            return False
        if each.opcode == "phi" and self.flow.defined[name][0] == around.header:
            return True
        return each.opcode in ("phi", "add") and any(
            self._is_carried(value, around, depth - 1) for value in each.operands if value != name
        )

    def _entering_value(self, name: str, loop: Loop) -> str:
        """The value of a term in the first iteration of `loop`."""
        each = self.flow.instruction(name)
        if each is None or each.opcode != "phi" or self.flow.defined[name][0] != loop.header:
            return name
        arms = arms_of(each)
        return arms[self.flow.entering(loop)]

    def _steps_free(self, variable: InductionVariable) -> bool:
        """A post-increment: the step is the width of an access that is made in every iteration.

        Either all accesses are in one block, or the first at the lowest address is made in every iteration of a loop that
        walks upwards, or downwards to the one end it has; the others then reach back from the stepped pointer
        [add_autoinc_candidates in tree-ssa-loop-ivopts.cc].
        """
        step = variable.increment.constant
        labels = {label for label, _, _ in variable.accesses}
        if variable.increment.symbolic:
            return False
        if len(labels) == 1 and self.flow.every_iteration(next(iter(labels)), variable.loop):
            return any(abs(step) == each.bits // 8 for _, each, _ in variable.accesses)
        assert variable.stepping is not None
        label, lowest, _ = variable.stepping
        downwards = self.profile.applies(Rule.DOWNWARD_POINTERS) and len(self.flow.exits(variable.loop)) == 1
        return (abs(step) if downwards else step) == lowest.bits // 8 and self.flow.every_iteration(
            label, variable.loop
        )


def is_merged_pointer(each: Instruction) -> bool:
    """Whether a phi merges addresses and is not a pointer that the loop carries."""
    is_choice = each.opcode == "phi" and each.text.startswith("phi ptr") and each.result not in each.operands
    return is_choice and not (each.result or "").endswith(EITHER)
