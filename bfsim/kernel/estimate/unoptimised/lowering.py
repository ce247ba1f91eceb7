"""The cost of each block of a kernel that no compiler optimised: GCC 12 for the Blackfin at -O0.

One statement at a time; every variable in memory; nothing kept in a register from one statement to the next;
no branch predicted. Measured against GCC's own code: see the README.
"""

from __future__ import annotations

from bfsim.kernel.costs.charges import BlockCost, Charge, charge
from bfsim.kernel.estimate.unoptimised.paths import Paths
from bfsim.kernel.estimate.unoptimised.stores import assign
from bfsim.kernel.estimate.unoptimised.trees import Trees
from bfsim.kernel.estimate.unoptimised.values import ExpressionCode
from bfsim.kernel.ir.text import BasicBlock, Routine, SourceLine
from bfsim.kernel.operations import COSTS, REGISTER_ARGUMENTS, Op
from bfsim.kernel.profile import CompilerProfile


def lower(routine: Routine, profile: CompilerProfile) -> dict[str, BlockCost]:
    """Return what each block of `routine` costs, by label."""
    return _UnoptimisedLowering(routine, profile).run()


class _UnoptimisedLowering:
    def __init__(self, routine: Routine, profile: CompilerProfile) -> None:
        self.routine, self.profile = routine, profile
        self.trees = Trees(routine)
        self.paths = Paths(routine, self.trees)
        self.saved: set[str] = set()
        self.costs = {block.label: BlockCost() for block in routine.blocks}

    def run(self) -> dict[str, BlockCost]:
        for label in self.paths.order:
            self._block(self.paths.blocks[label])
        self._enter()
        for label in self.paths.order:
            if not self.paths.blocks[label].successors:
                self._leave(self.paths.blocks[label])
        return self.costs

    def _block(self, block: BasicBlock) -> None:
        code = ExpressionCode(self.profile, block.terminator.line)
        if block.label in self.paths.landed:
            code.op(Op.MOVE)  # a NOP
        for each in self.trees.statements(block):
            assign(code, each)
        code.line = block.terminator.line
        branch = self.paths.branches[block.label]
        if branch:
            code.condition(self.trees.condition(branch.value))
        elif block.terminator.opcode == "ret" and block.terminator.operands:
            code.copied(self.trees.expr(block.terminator.operands[0], block.label))
        cost = self.costs[block.label]
        cost.charges, cost.nbytes, cost.accesses = code.charges, code.nbytes, code.accesses
        self.saved |= code.saved
        self._go(block, cost)

    def _go(self, block: BasicBlock, cost: BlockCost) -> None:
        """The branch or jump at the end of `block`."""
        line = block.terminator.line
        follows = self.paths.next_of(block.label)
        branch = self.paths.branches[block.label]
        if branch:
            sides = [self.paths.target(each) for each in (branch.if_true, branch.if_false)]
            falls = follows if follows in sides else sides[1]
            stays = [
                charge(Op.BRANCH_NOT_TAKEN, line),
                *([] if falls == follows else [charge(Op.JUMP, line)]),
            ]
            if_true, if_false = (
                tuple(stays) if each == falls else (charge(Op.BRANCH_TAKEN, line),) for each in sides
            )
            cost.branch(branch.value, if_true, if_false)
            cost.nbytes += _nbytes(stays)
            return
        way = self.paths.only_way(block)
        if way and block.label not in self.paths.empty and self.paths.target(way) != follows:
            cost.add(line, Op.JUMP)

    def _enter(self) -> None:
        first = self.routine.blocks[0]
        cost, line = self.costs[first.label], first.instructions[0].line
        arguments = [each for each in self.routine.parameters if not each.endswith(".len")]
        frame = [Op.LINK, *(Op.STORE32,) * min(len(arguments), REGISTER_ARGUMENTS)]
        saving = self._save(Op.PUSH_MULTIPLE, self.profile.push_multiple_cclk, line)
        cost.charges[:0] = [*saving, *(charge(op, line) for op in frame)]
        cost.nbytes += sum(COSTS[each].nbytes for each in frame) + _nbytes(saving)

    def _leave(self, block: BasicBlock) -> None:
        cost, line = self.costs[block.label], block.terminator.line
        if not block.terminator.operands and block.label not in self.paths.landed:
            cost.add(line, Op.MOVE)  # a NOP
        if self.paths.next_of(block.label):
            cost.add(line, Op.JUMP)
        cost.add(line, Op.UNLINK, Op.RETURN)
        restoring = self._save(Op.POP_MULTIPLE, self.profile.pop_multiple_cclk, line)
        cost.charges += restoring
        cost.nbytes += _nbytes(restoring)

    def _save(self, op: Op, cclk: int | None, line: SourceLine) -> list[Charge]:
        """Save or restore the registers that keep values during calls."""
        return [Charge(op, line, len(self.saved) if cclk is None else cclk)] if self.saved else []


def _nbytes(charges: list[Charge]) -> int:
    return sum(COSTS[each.op].nbytes for each in charges)
