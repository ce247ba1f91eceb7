"""The cost of every basic block: issue cycles per source line, and what its branches cost each way.

The result is a list of counters. How often each counter's event happened in a run, times its cycles,
summed, is the issue time of the run: exactly the blocks that were costed are the blocks that are counted.
"""

from __future__ import annotations

from collections import Counter as Tally
from dataclasses import dataclass

from bfsim.kernel.ir_text import Block, Routine
from bfsim.kernel.isa import (
    ISSUE_CCLK,
    NOT_TAKEN_BP_CCLK,
    NOT_TAKEN_CCLK,
    TAKEN_BP_CCLK,
    TAKEN_CCLK,
    Op,
)
from bfsim.kernel.loops import Flow
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.select import Operation, Selection, Selector, Test


@dataclass(frozen=True, slots=True)
class Counter:
    """An event that is counted: the execution of block `label`, or of its test `value` being true.

    `line_cclk`: issue cycles per event and source line. `accesses`: (array, reads, writes) per event.
    """

    routine: str
    label: str
    value: str | None
    equals: int | None
    line_cclk: tuple[tuple[int, int], ...]
    accesses: tuple[tuple[str, int, int], ...]

    @property
    def cclk(self) -> int:
        """Issue cycles per event."""
        return sum(cycles for _, cycles in self.line_cclk)


def cost(routine: Routine, profile: CompilerProfile) -> tuple[Counter, ...]:
    """Cost every block of `routine`; one counter per block, and one per branch whose sides cost differently."""
    scheduler = _Scheduler(routine, profile)
    counters: list[Counter] = []
    for block in routine.blocks:
        counters.extend(scheduler.block(block))
    return tuple(counters)


class _Scheduler:
    def __init__(self, routine: Routine, profile: CompilerProfile) -> None:
        self.routine = routine
        self.flow = Flow(routine)
        self.selector = Selector(self.flow, profile)
        self.profile = profile
        self.layout = _layout(self.flow)
        self.has_calls = any(
            each.opcode == "call" and "@llvm." not in each.text
            for block in routine.blocks
            for each in block.instructions
        )

    def block(self, block: Block) -> list[Counter]:
        selection = self.selector.block(block)
        self._function_edges(block, selection)
        self._loop_edges(block, selection)
        self._branch(block, selection)
        cycles: Tally[int] = Tally()
        for operation in selection.operations:
            cycles[operation.line] += operation.cclk
        whole = Counter(
            self.routine.symbol, block.label, None, None, tuple(sorted(cycles.items())), self._accesses(block)
        )
        tests = [
            Counter(
                self.routine.symbol, block.label, each.value, each.equals, ((each.line, each.extra_cclk),), ()
            )
            for each in selection.tests
            if each.extra_cclk
        ]
        return [whole, *tests]

    def _function_edges(self, block: Block, selection: Selection) -> None:
        """What enters and leaves the function; one that calls saves its registers first."""
        saved = self.profile.saved_registers if self.has_calls else 0
        first = block.instructions[0].line
        if block is self.routine.blocks[0] and self.has_calls:
            selection.add(first, Op.LINK, *[Op.PUSH] * saved)
        if block.terminator.opcode == "ret":
            if self.has_calls:
                selection.add(block.terminator.line, *[Op.POP] * saved, Op.UNLINK)
            selection.add(block.terminator.line, Op.RETURN)

    def _loop_edges(self, block: Block, selection: Selection) -> None:
        """Setting up the hardware loops that this block enters, and stepping the pointers of the one it closes."""
        for loop in self.flow.loops:
            outside = block.label not in loop.blocks and loop.header in block.successors
            if outside and self.selector.is_hardware_loop(loop):
                selection.add(block.terminator.line, Op.LOOP_SETUP)
            if block.label == loop.latch:
                selection.add(block.terminator.line, *[Op.ALU] * self.selector.walked_pointers(loop))

    def _branch(self, block: Block, selection: Selection) -> None:
        terminator = block.terminator
        if terminator.opcode == "switch":
            self._switch(block, selection)
        elif terminator.opcode == "br" and not terminator.operands:
            self._jump(block, block.successors[0], selection)
        elif terminator.opcode == "br":
            self._conditional(block, selection)

    def _jump(self, block: Block, target: str, selection: Selection) -> None:
        if not self._falls_to(block.label, target) and not self._closes_hardware_loop(block.label, target):
            selection.add(block.terminator.line, Op.JUMP)

    def _conditional(self, block: Block, selection: Selection) -> None:
        """`IF CC JUMP`: one side falls through; a back edge and a skip over a body are predicted taken."""
        yes, no = block.successors
        line, condition = block.terminator.line, block.terminator.operands[0]
        if self._closes_hardware_loop(block.label, yes) or self._closes_hardware_loop(block.label, no):
            return
        through, other = (yes, no) if self._falls_to(block.label, yes) else (no, yes)
        predicted = self._is_back_edge(block.label, other) or self._skips(through, other)
        fall, taken = (NOT_TAKEN_BP_CCLK, TAKEN_BP_CCLK) if predicted else (NOT_TAKEN_CCLK, TAKEN_CCLK)
        if not self._falls_to(block.label, through):
            fall += ISSUE_CCLK[Op.JUMP]
        yes_cclk, no_cclk = (fall, taken) if through == yes else (taken, fall)
        selection.operations.append(Operation(Op.JUMP, line, no_cclk))
        selection.tests.append(Test(condition, None, line, yes_cclk - no_cclk))

    def _switch(self, block: Block, selection: Selection) -> None:
        """A chain of compare and branch, in the order of the cases."""
        value, line = block.terminator.operands[0], block.terminator.line
        step = ISSUE_CCLK[Op.COMPARE] + NOT_TAKEN_CCLK
        none_cclk = step * len(block.cases)
        selection.operations.append(Operation(Op.JUMP, line, none_cclk))
        for index, (case, _) in enumerate(block.cases):
            hit_cclk = step * index + ISSUE_CCLK[Op.COMPARE] + TAKEN_CCLK
            selection.tests.append(Test(value, case, line, hit_cclk - none_cclk))

    def _falls_to(self, label: str, target: str) -> bool:
        return self.layout.get(target) == self.layout[label] + 1

    def _is_back_edge(self, label: str, target: str) -> bool:
        return target in self.flow.dominators[label]

    def _skips(self, body: str, join: str) -> bool:
        """Whether `body` leads to `join` and nowhere else: an `if` without `else`."""
        return self.flow.blocks[body].successors == (join,)

    def _closes_hardware_loop(self, label: str, target: str) -> bool:
        return any(
            loop.latch == label and loop.header == target and self.selector.is_hardware_loop(loop)
            for loop in self.flow.loops
        )

    def _accesses(self, block: Block) -> tuple[tuple[str, int, int], ...]:
        """Reads and writes of each array, by the parameter's name; other memory has none."""
        reads: Tally[str] = Tally()
        writes: Tally[str] = Tally()
        for each in block.instructions:
            if each.opcode in ("load", "store"):
                root = self.selector.root(each.operands[-1])
                if root in self.routine.parameters:
                    (reads if each.opcode == "load" else writes)[root[1:]] += 1
        return tuple((name, reads[name], writes[name]) for name in sorted(reads | writes))


def _layout(flow: Flow) -> dict[str, int]:
    """Position of each block in the code: as the source has it, `then` before `else`, a loop's body before its exit."""
    order: list[str] = []  # what has been visited with all that follows it: last in the code first
    entry = flow.routine.blocks[0].label
    seen, open_visits = {entry}, [(entry, iter(_last_first(flow, entry)))]
    while open_visits:
        label, successors = open_visits[-1]
        following = next((each for each in successors if each not in seen), None)
        if following is None:
            order.append(label)
            open_visits.pop()
        else:
            seen.add(following)
            open_visits.append((following, iter(_last_first(flow, following))))
    return {label: index for index, label in enumerate(reversed(order))}


def _last_first(flow: Flow, label: str) -> list[str]:
    """Successors of a block, the one that should come last in the code first: exits of its loop, then from the end."""
    successors = list(flow.blocks[label].successors)
    if flow.blocks[label].terminator.opcode == "switch":
        successors = [*successors[1:], successors[0]]
    loop = flow.innermost(label)
    leaving = [each for each in successors if loop is not None and each not in loop.blocks]
    staying = [each for each in successors if each not in leaving]
    return [*reversed(leaving), *reversed(staying)]
