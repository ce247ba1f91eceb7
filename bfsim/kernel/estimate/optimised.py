"""The cost of each block of a kernel that a compiler optimised (-O2)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from bfsim.kernel import operations
from bfsim.kernel.costs.charges import BlockCost, Charge, charge, instead
from bfsim.kernel.estimate.layout.block_order import ordered
from bfsim.kernel.estimate.layout.branch_costs import BranchCosts
from bfsim.kernel.estimate.layout.code_blocks import CodeBlocks, Landing, edge_of
from bfsim.kernel.estimate.layout.cross_jumps import CrossJumps
from bfsim.kernel.estimate.layout.frame_costs import FrameCosts
from bfsim.kernel.estimate.layout.hardware_loops import HardwareLoops
from bfsim.kernel.estimate.layout.memory_call_costs import add_memory_call
from bfsim.kernel.estimate.layout.switch_costs import add_switch
from bfsim.kernel.estimate.registers.registers import allocate
from bfsim.kernel.estimate.scheduling.bundles import bundled
from bfsim.kernel.estimate.scheduling.schedule import Issue, issues
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.iteration_counts import IterationCounts
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction
from bfsim.kernel.estimate.selection.select import select
from bfsim.kernel.ir.control_flow import BACK, Loop
from bfsim.kernel.ir.text import BasicBlock, Routine, SourceLine
from bfsim.kernel.operations import COSTS, Op
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule

ALONE = Issue()


def lower(routine: Routine, profile: CompilerProfile) -> dict[str, BlockCost]:
    """Return what each block of `routine` costs, by label."""
    lowering = _OptimisedLowering(routine, profile)
    return {block.label: lowering.block(block) for block in routine.blocks}


class _OptimisedLowering:
    def __init__(self, routine: Routine, profile: CompilerProfile) -> None:
        self.context = Context(routine, profile)
        self.flow, self.profile = self.context.flow, profile
        self.counts = IterationCounts(self.context)
        self.code = select(self.context)
        self.allocation = allocate(self.context, self.code)
        self.frame = FrameCosts(self.allocation, profile)
        bundles = profile.applies(Rule.BUNDLES)
        self.bundled = bundled(self.context, self.code, self.allocation) if bundles else frozenset()
        empty = set(self.context.replaced) | {label for label in self.flow.blocks if self._is_empty(label)}
        copies = {
            edge: [self._charge(instruction) for instruction in steps]
            for edge, steps in self.allocation.on_edges.items()
        }
        self.skipped = frozenset(empty | self.context.if_conversion.gone | self.context.second_parts.keys())
        landing = Landing(self.flow, self.skipped, self.context.second_parts)
        self.crossed = CrossJumps(self.context, self.code, self.allocation, landing)
        self.blocks = CodeBlocks(self.flow, landing, copies, self.crossed, dict(self._threaded()))
        ways_back = frozenset(self._way_back(loop) for loop in self._counted())
        self.layout = ordered(self.blocks, self.context.likelihood, self._nbytes, ways_back)
        self.hardware = HardwareLoops(self.context, self.code, self.allocation, self.layout)
        self.hardware.reorder(self.layout)
        self.branches = BranchCosts(self.blocks, self.layout, self.context.likelihood, copies)

    def _nbytes(self, name: str) -> int:
        """Code bytes of a block with its branch or return, or of the copies on an edge."""
        nbytes = sum(each.code_bytes for each in self._code_at(name))
        if name in self.crossed.tails:
            return nbytes - sum(each.code_bytes for each in self._code_at(self.crossed.tails[name]))
        block = self.flow.blocks.get(name)
        if block is not None and block.terminator.opcode == "ret":
            leaving = self.frame.leaving(block.terminator.line)
            return nbytes + sum(COSTS[each.op].nbytes for each in leaving)
        if any(self.flow.ending(loop) == name for loop in self._counted()):
            return nbytes + operations.LOOP_END_BYTES
        if block is None or self.context.jump_threading.decides(block.terminator):
            return nbytes
        branches = len(set(block.successors)) > 1
        return nbytes + (COSTS[Op.BRANCH_TAKEN].nbytes if branches else 0)

    def _threaded(self) -> Iterator[tuple[tuple[str, str], str]]:
        """Edges from blocks that set a flag that ends their loop, and where they lead."""
        for loop in self.flow.loops:
            tests = [
                self.flow.blocks[each]
                for each in self.flow.inside(loop)
                if self.context.jump_threading.decides(self.flow.blocks[each].terminator)
            ]
            ends = [way for test in tests for way in test.successors if way not in loop.blocks | loop.leaving]
            for label in loop.leaving if ends else ():
                for way in set(self.flow.blocks[label].successors) & loop.blocks:
                    yield (label, way), ends[0]

    def _counted(self) -> Iterator[Loop]:
        return (loop for loop in self.flow.loops if loop.header in self.context.counters.counted)

    def _way_back(self, loop: Loop) -> tuple[str, str]:
        """The jump at the end of a counted loop, which GCC cannot invert."""
        ending = self.flow.ending(loop)
        if ending == loop.latch or self.flow.is_split(loop):
            return ending, loop.header
        return ending, next(way for way in self.flow.blocks[ending].successors if way in loop.blocks)

    def _is_empty(self, label: str) -> bool:
        block = self.flow.blocks[label]
        is_latch = any(loop.latch == label for loop in self.flow.loops) and not label.endswith(BACK)
        return not self.code.of[label] and len(block.successors) == 1 and not is_latch and (
            label != self.flow.routine.blocks[0].label
        )  # fmt: skip

    def block(self, block: BasicBlock) -> BlockCost:
        cost = BlockCost()
        instructions = self.code.of[block.label]
        if block is self.flow.routine.blocks[0]:
            self._enter(cost, block.instructions[0].line)
        before = len(cost.charges)
        cost.charges += [
            self._charge(instruction, issue)
            for instruction, issue in zip(instructions, self._issues(block.label), strict=True)
        ]
        self._loops(block, cost)
        self._leave_block(block, cost)
        others = cost.charges[:before] + cost.charges[before + len(instructions) :]
        cost.accesses = [each.access for each in instructions if each.access is not None]
        for call in self.context.memory_calls.get(block.label, ()):
            add_memory_call(cost, call)
        cost.nbytes = sum(each.code_bytes for each in instructions) + sum(
            COSTS[each.op].nbytes for each in others
        )
        return cost

    def _issues(self, label: str) -> list[Issue]:
        instructions = self.code.of[label]
        found = [ALONE] * len(instructions)
        if self.profile.interlocks:
            found = issues(instructions, self.allocation.bank.get, parallel=self.profile.parallel_issue)
        return [
            replace(each, paired=True) if (label, number) in self.bundled else each
            for number, each in enumerate(found)
        ]

    def _charge(self, instruction: MachineInstruction, issue: Issue = ALONE) -> Charge:
        cclk = COSTS[instruction.op].cclk if instruction.cclk is None else instruction.cclk
        return Charge(
            instruction.op,
            instruction.line,
            0 if issue.paired else cclk,
            issue.stall_cclk,
            routine=instruction.routine,
        )

    # Function

    def _enter(self, cost: BlockCost, line: SourceLine) -> None:
        cost.charges += [charge(Op.NOP, line)] * self._padding()
        cost.charges += self.frame.entering(line)
        cost.charges += [self._charge(instruction) for instruction in self.allocation.entry]

    def _padding(self) -> int:
        """NOPs before a function whose RTS comes too early [workaround_rts_anomaly in bfin.cc of GCC 12]."""
        if self.allocation.calls or self.allocation.saved_data or self.allocation.saved_pointers:
            return 0
        left = operations.CYCLES_BEFORE_RETURN - len(self.allocation.entry)
        for label in self.layout.order:
            left -= sum(_hides(each) for each in self._code_at(label))
            block = self.flow.blocks.get(label)
            if block is not None and len(set(block.successors)) == 2:
                left -= label not in self.context.if_conversion.by_label
            elif block is not None and block.terminator.opcode == "ret":
                return max(left, 0)
            elif not self.branches.falls(label, self.blocks.ways(label)[0]):
                return 0
            if left <= 0 or label in self.context.tail_calls:
                return 0
        return 0

    def _code_at(self, name: str) -> list[MachineInstruction]:
        """Instructions of a block, or of the copies on an edge."""
        return self.code.of[name] if name in self.flow.blocks else self.allocation.on_edges[edge_of(name)]

    # Loops and branches

    def _loops(self, block: BasicBlock, cost: BlockCost) -> None:
        for loop in self.flow.loops:
            if loop.header not in self.context.counters.counted or loop.header in self.context.replaced:
                continue
            line = self.flow.blocks[loop.header].instructions[-1].line
            line = self.flow.blocks[loop.latch].terminator.line or line
            if block.label == self.flow.entering(loop):
                cost.charges += [charge(each, line) for each in self.counts.operations(loop)]
                if loop.header in self.hardware.all:
                    cost.charges.append(charge(Op.LOOP_SETUP, line))
                    if self.hardware.begins_with_copies(loop) and self.branches.falls(
                        block.label, loop.header
                    ):
                        cost.charges.append(charge(Op.JUMP, line))

    def _leave_block(self, block: BasicBlock, cost: BlockCost) -> None:
        terminator, label = block.terminator, block.label
        if label in self.context.replaced or (
            label in self.context.if_conversion.gone and len(set(block.successors)) > 1
        ):
            return
        if label in self.context.tail_calls:
            left_out = self.context.tail_calls[label].left_out
            cost.charges.append(charge(Op.RETURN, left_out.line)._replace(times=-1))
        if terminator.opcode == "ret":
            cost.charges += self.frame.leaving(terminator.line)
        elif terminator.opcode == "switch":
            add_switch(cost, block, self.flow)
        elif label in self.context.tail_calls:
            pass  # the called function returns
        elif terminator.opcode == "br" and len(set(block.successors)) == 1:
            if label not in self.skipped:
                cost.charges += self.branches.on(label, block.successors[0], terminator.line)
        elif terminator.opcode == "br" and label in self.context.if_conversion.by_label:
            join, _ = self.flow.defined[self.context.if_conversion.by_label[label].phi.result or ""]
            cost.charges += self.branches.jump(label, self.blocks.landing(join), terminator.line)
        elif terminator.opcode == "br":
            self._conditional(block, cost)

    def _conditional(self, block: BasicBlock, cost: BlockCost) -> None:
        label, line = block.label, block.terminator.line
        if label in self.context.second_parts:
            sides = self._second_part(label, line)
        elif self.context.jump_threading.decides(block.terminator) or self.flow.is_overflow_guard(block):
            sides = tuple(self.branches.on(label, way, line) for way in block.successors)
        else:
            to_cc = [Op.CC_MOVE] * self.context.is_kept(block) + [Op.BIT_TEST] * self.context.tests_flag(
                block
            )
            cost.charges += [charge(each, line) for each in to_cc]
            cost.nbytes += sum(COSTS[each].nbytes for each in to_cc)
            sides = self._branch(label, line)
        cost.branch(block.terminator.operands[0], tuple(sides[0]), tuple(sides[1]))

    def _second_part(self, label: str, line: SourceLine) -> tuple[list[Charge], ...]:
        """The extra cost if the second part of a test does not hold after all: the branch was before it."""
        tested = self.context.ranges[label]
        before = self.branches.sides(tested.first, line)
        first = self.flow.blocks[tested.first].successors.index(label)
        sides = []
        for way in self.flow.blocks[label].successors:
            copied = self.branches.copies.get((label, way), [])
            sides.append(
                [*copied, *(() if way == tested.inside else instead(before[1 - first], before[first]))]
            )
        return tuple(sides)

    def _branch(self, label: str, line: SourceLine) -> tuple[list[Charge], list[Charge]]:
        loop = next(
            (
                each
                for each in self.flow.loops
                if self.flow.ending(each) == label and each.header in self.context.counters.counted
            ),
            None,
        )
        if loop is None:
            return self.branches.sides(label, line)
        again, leaving = [], []
        if loop.header not in self.hardware.all:
            count = [charge(Op.ALU, line), charge(Op.COMPARE, line)]
            again = [*count, charge(Op.BRANCH_TAKEN, line)]
            leaving = [*count, charge(Op.BRANCH_NOT_TAKEN, line)]
        elif self.hardware.ends_in_branch(loop):
            again = leaving = [charge(Op.NOP, line)]
        ways = self.flow.blocks[label].successors
        out = ways[0] if ways[0] not in loop.blocks else ways[1]
        leaving = leaving + self.branches.on(label, out, line)
        stays = ways[0] if out == ways[1] else ways[1]
        if moves := self.branches.copies.get((label, stays), []):
            again = [*again, *moves]
            if loop.header not in self.hardware.all:
                again.append(charge(Op.JUMP, line))
        return (again, leaving) if ways[0] == stays else (leaving, again)


def _hides(instruction: MachineInstruction) -> int:
    """Cycles by which an instruction delays an RTS after it; a branch in a block counts with what it skips."""
    if instruction.op is Op.BRANCH_TAKEN_BP:
        return 2
    return operations.PRODUCT_BEFORE_RETURN if instruction.op is Op.MUL32 else 1
