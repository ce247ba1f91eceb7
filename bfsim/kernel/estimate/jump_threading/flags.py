"""Jump threading of flags: variables that are only ever set to constants and tested.

Compilers thread the jump: each place that sets the flag goes straight to where the test would lead, and neither flag
nor test remains [tree-ssa-threadbackward.cc of GCC 12].
"""

from __future__ import annotations

from collections.abc import Callable

from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, arms_of, is_constant, predicate


class JumpThreading:
    """The flags of one routine, and their tests."""

    def __init__(self, flow: ControlFlow) -> None:
        self.flow = flow
        phis = {
            each.result or "": each
            for block in flow.routine.blocks
            for each in block.instructions
            if each.opcode == "phi" and not each.text.startswith("phi ptr")
        }
        self.names = {name for name, each in phis.items() if self._is_tested(each)}
        self._keep(lambda name: self._is_set_to_constants(phis[name]) and self._is_only_tested(name))
        carried = {name for name in self.names if self._is_carried(name)}
        self._keep(
            lambda name: (
                name not in carried and self._is_set_to_constants(phis[name]) and self._is_only_tested(name)
            )
        )

    def _keep(self, is_flag: Callable[[str], bool]) -> None:
        """Drop those that are no flags, and then those that depend on them."""
        changed = True
        while changed:
            kept = {name for name in self.names if is_flag(name)}
            changed, self.names = kept != self.names, kept

    def _is_carried(self, name: str) -> bool:
        """Whether a loop carries a flag from iteration to iteration: no jump is threaded through the head of a loop.

        A flag that ends the loop once it is set is always the same in it.
        """
        home = self.flow.defined[name][0]
        loop = next((each for each in self.flow.loops if each.header == home), None)
        return loop is not None and len(self._values(name, loop, set())) > 1

    def _values(self, name: str, loop: Loop, seen: set[str]) -> set[str]:
        """Constants that a flag may have in the iterations of `loop`."""
        seen.add(name)
        home, phi = self.flow.defined[name]
        found: set[str] = set()
        for source, value in arms_of(phi).items():
            if source in loop.blocks and self._sets_an_end(source, home, loop):
                continue
            if _is_constant(value):
                found.add(value)
            elif value not in seen:
                found |= self._values(value, loop, seen)
        return found

    def _is_tested(self, phi: Instruction) -> bool:
        return bool(self.flow.users.get(phi.result or ""))

    def _is_set_to_constants(self, phi: Instruction) -> bool:
        return all(_is_constant(operand) or operand in self.names for operand in phi.operands)

    def _is_only_tested(self, name: str) -> bool:
        users = self.flow.users.get(name, [])
        return all(
            user.result in self.names or user.opcode == "br" or self.is_test(user, name) for user in users
        )

    def is_test(self, each: Instruction, name: str | None = None) -> bool:
        """Whether `each` compares a flag with a constant, for a branch."""
        if each.opcode != "icmp" or not _is_constant(each.operands[1]):
            return False
        flag = each.operands[0] in self.names if name is None else each.operands[0] == name
        return flag and all(user.opcode == "br" for user in self.flow.users.get(each.result or "", []))

    def leaving(self, loop: Loop) -> frozenset[str]:
        """Blocks of `loop` that set a flag that ends it: once the jump is threaded, they are outside."""
        staying = {loop.latch}
        waiting = [loop.latch]
        while waiting:
            label = waiting.pop()
            if label == loop.header:
                continue
            for before in self.flow.predecessors[label]:
                if (
                    before in loop.blocks
                    and before not in staying
                    and not self._sets_an_end(before, label, loop)
                ):
                    staying.add(before)
                    waiting.append(before)
        return loop.blocks - staying - {loop.header}

    def _sets_an_end(self, before: str, label: str, loop: Loop) -> bool:
        """Whether a flag that is constant on the edge makes the header's test leave the loop."""
        branch = self.flow.blocks[loop.header].terminator
        test = self.flow.instruction(branch.operands[0]) if branch.operands else None
        if test is None or not self.is_test(test):
            return False
        way_out = [way not in loop.blocks for way in self.flow.blocks[loop.header].successors]
        for phi in self.flow.blocks[label].instructions:
            if (
                phi.opcode == "phi"
                and phi.result in self.names
                and self._reaches(phi.result or "", test.operands[0])
            ):
                value = arms_of(phi).get(before, "")
                if _is_constant(value):
                    holds = (value == test.operands[1]) == (predicate(test) == "eq")
                    return predicate(test) in ("eq", "ne") and way_out[0 if holds else 1]
        return False

    def _reaches(self, name: str, tested: str, depth: int = 4) -> bool:
        """Whether the tested flag is `name`, or takes its value from it."""
        if name == tested:
            return True
        each = self.flow.instruction(tested)
        return each is not None and depth > 0 and any(
            self._reaches(name, operand, depth - 1) for operand in each.operands if operand in self.names
        )  # fmt: skip

    def decides(self, branch: Instruction) -> bool:
        """Whether a branch tests a flag, so that it is threaded away."""
        if branch.opcode != "br" or not branch.operands:
            return False
        test = self.flow.instruction(branch.operands[0])
        return branch.operands[0] in self.names or (test is not None and self.is_test(test))


def _is_constant(operand: str) -> bool:
    return is_constant(operand)
