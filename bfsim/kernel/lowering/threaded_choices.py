"""A way on which a number was chosen leads past later tests of it [tree-ssa-threadbackward.cc of GCC 12].

Of `now = 2 if y < upper else 0`, then `if now == s: continue`, and then `if now == 2 and ...`, GCC copies what lies between, so that the last
test is made on no way. LLVM's jump threading does so where the test follows at once. The ways are copied while variables are in memory, as
those of `state_machines`, and none past the start of a loop.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import llvmlite.binding as llvm

from bfsim.kernel import generic
from bfsim.kernel.ir_text import (
    BasicBlock,
    Instruction,
    Routine,
    arms_of,
    is_number,
    predicate,
    read_module,
    renamed,
    with_names,
    write_module,
)
from bfsim.kernel.loops import ControlFlow
from bfsim.kernel.lowering.copied_ways import TRUTHS, CopiedWays, Node, Ways, answered
from bfsim.kernel.lowering.number_tests import CONVERSIONS

MOST_ON_A_WAY = 7
"""Instructions that are copied on a way [param_max_jump_thread_duplication_stmts by param_fsm_scale_path_stmts]."""


def with_threaded_choices(module: llvm.ModuleRef) -> llvm.ModuleRef:
    """Return a module with copies of such ways; of one without any, the module itself."""
    text = with_names(str(module))
    told = [_with_truths(each) for each in read_module(text)]
    tests = {each.symbol: labels for each in told if (labels := set(_tests(ControlFlow(each))))}
    if not tests:
        return module
    module = llvm.parse_assembly(write_module(text, told))
    generic.run(("register_to_memory",), module)
    text = with_names(str(module))
    threaded = [_threaded(each, tests.get(each.symbol, set())) for each in read_module(text)]
    module = llvm.parse_assembly(write_module(text, threaded))
    generic.run(("sroa", "simplify_cfg"), module)
    return module


def _with_truths(routine: Routine) -> Routine:
    """Return `routine` with what comparisons of two numbers say in place of them, as a flag that is set is written."""
    said = {
        each.result or "": str(bool(is_so)).lower()
        for block in routine.blocks
        for each in block.instructions
        if each.opcode == "icmp"
        and all(map(is_number, each.operands))
        and (is_so := answered(predicate(each), *map(int, each.operands))) is not None
    }
    if not said:
        return routine
    blocks = (
        replace(
            block,
            instructions=tuple(renamed(each, said) for each in block.instructions if each.result not in said),
        )
        for block in routine.blocks
    )
    return replace(routine, blocks=tuple(blocks))


def _tests(flow: ControlFlow) -> Iterator[str]:
    """Blocks that end with a test of what was chosen in a block before, in the same loop, where it may have been a number."""
    headers = {loop.header for loop in flow.loops}
    for block in flow.routine.blocks:
        chosen = _tested(flow, block)
        if chosen is None or chosen.opcode != "phi":
            continue
        home = flow.defined[chosen.result or ""][0]
        is_behind = home != block.label and home not in headers
        if is_behind and flow.innermost(home) is flow.innermost(block.label) and _has_number(chosen):
            yield block.label


def _has_number(phi: Instruction) -> bool:
    return any(is_number(each) or each in TRUTHS for each in arms_of(phi).values())


def _tested(flow: ControlFlow, block: BasicBlock) -> Instruction | None:
    """What a block compares with a number, or the truth it branches by."""
    if block.terminator.opcode != "br" or len(set(block.successors)) != 2:
        return None
    each = flow.instruction(block.terminator.operands[0])
    if each is not None and each.opcode == "icmp":
        each = flow.instruction(each.operands[0]) if is_number(each.operands[1]) else None
    while each is not None and each.opcode in CONVERSIONS:
        each = flow.instruction(each.operands[0])
    return each


def _threaded(routine: Routine, tests: set[str]) -> Routine:
    if not tests:
        return routine
    choices = _Choices(ControlFlow(routine), tests)
    choices.thread()
    return choices.routine()


class _Choices(CopiedWays):
    """Copies ways to tests of numbers that were chosen before."""

    ending = "so"

    def __init__(self, flow: ControlFlow, tests: set[str]) -> None:
        super().__init__(flow)
        self.tests = tests

    def thread(self) -> None:
        """Lead each block that sets such a number past the tests of it, loop by loop."""
        loops = {
            loop.header if (loop := self.flow.innermost(each)) else "": loop for each in sorted(self.tests)
        }
        for loop in loops.values():
            inside = [label for label in self.flow.order if self.flow.innermost(label) is loop]
            tests = [label for label in inside if label in self.tests]
            asked = [_tested(self.flow, self.flow.blocks[label]) for label in tests]
            self.variables = self.copied_to(
                {each.operands[-1] for each in asked if each is not None and each.opcode == "load"}
            )
            behind = set(inside) - {loop.header if loop else ""}
            passed = behind.intersection(tests)
            self.leading = self.blocks_before(passed, passed, behind)
            self.copies.clear()
            for label in inside:
                self.lead(label)

    def is_past(self, block: BasicBlock, way: str) -> bool:
        """Whether a block makes such a test."""
        return block.label in self.tests

    def short_ways(self, nodes: Mapping[Node, Ways], first: Node) -> set[Node]:
        """A way is copied up to a test, of which GCC makes no copy, if that is not too much."""
        cost = {node: self._cost(each) for node, each in nodes.items()}
        before = _least({first: 0} if first in nodes else {}, nodes, cost)
        back: dict[Node, list[Node]] = {node: [] for node in nodes}
        for node, of in nodes.items():
            for way in _behind(of) & nodes.keys():
                back[way].append(node)
        past = {node: cost[node] for node, each in nodes.items() if each.is_past}
        found = dict(past)
        waiting = [*past]
        while waiting:
            node = waiting.pop()
            for each in back[node]:
                if found[node] + cost[each] < found.get(each, MOST_ON_A_WAY + 1):
                    found[each] = found[node] + cost[each]
                    waiting.append(each)
        return {node for node in before if before[node] + found.get(node, MOST_ON_A_WAY + 1) <= MOST_ON_A_WAY}

    def _cost(self, of: Ways) -> int:
        """What a copy of a block costs, without accesses of variables and what decides where it leads if that is known."""
        rows = [each for each in of.block.instructions if not self._is_free(each)]
        decides = sum(each.opcode in ("icmp", "br") for each in rows[-2:])
        return len(rows) - (decides if len(of.ways) == 1 else 0)

    def _is_free(self, each: Instruction) -> bool:
        if each.opcode in ("load", "store"):
            place = self.flow.instruction(each.operands[-1])
            return place is not None and place.opcode == "alloca"
        return each.opcode in CONVERSIONS

    def goes_on(self, found: Ways) -> bool:
        """What is known of other numbers may lead past other tests."""
        return True


def _behind(of: Ways) -> set[Node]:
    return {(way, of.known) for way in of.ways}


def _least(first: dict[Node, int], nodes: Mapping[Node, Ways], cost: Mapping[Node, int]) -> dict[Node, int]:
    """The least that ways from the first node to each other one cost before it."""
    found, waiting = dict(first), [*first]
    while waiting:
        node = waiting.pop()
        for each in _behind(nodes[node]) & nodes.keys():
            if found[node] + cost[node] < found.get(each, MOST_ON_A_WAY + 1):
                found[each] = found[node] + cost[node]
                waiting.append(each)
    return found
