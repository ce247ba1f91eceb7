"""Paths on which a number was chosen: they lead past later tests of it [tree-ssa-threadbackward.cc of GCC 12].

For `now = 2 if y < upper else 0`, then `if now == s: continue`, and then `if now == 2 and ...`, GCC copies the code in
between, so that the last test is never made. LLVM's jump threading does so only if the test follows at once. The paths
are copied while variables are in memory, as in `state_machines`, and none goes past the start of a loop.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import llvmlite.binding as llvm

from bfsim.kernel.estimate.conditions.number_tests import CONVERSIONS
from bfsim.kernel.estimate.switches.copied_ways import (
    CopiedWays,
    Node,
    Ways,
    answered,
    copied_to,
)
from bfsim.kernel.ir import llvm_passes
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.ir.text import (
    BasicBlock,
    Instruction,
    Routine,
    arms_of,
    is_constant,
    is_number,
    predicate,
    renamed,
)
from bfsim.kernel.ir.writing import with_names, write_module

MOST_ON_A_WAY = 7
"""Most instructions that are copied on a path [param_max_jump_thread_duplication_stmts by param_fsm_scale_path_stmts]."""


def with_threaded_choices(module: llvm.ModuleRef) -> llvm.ModuleRef:
    """Return a module with copies of such paths, or the module itself if there are none."""
    text = with_names(str(module))
    told = [_with_truths(each) for each in read_module(text)]
    tests = {each.symbol: labels for each in told if (labels := set(_tests(ControlFlow(each))))}
    if not tests:
        return module
    module = llvm.parse_assembly(write_module(text, told))
    llvm_passes.run(("register_to_memory",), module)
    text = with_names(str(module))
    threaded = [_threaded(each, tests.get(each.symbol, set())) for each in read_module(text)]
    module = llvm.parse_assembly(write_module(text, threaded))
    llvm_passes.run(("sroa", "simplify_cfg"), module)
    return module


def _with_truths(routine: Routine) -> Routine:
    """Return `routine` with the results of comparisons of two numbers in place of the comparisons, as for a flag that is set."""
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
    """Blocks that end with a test of what an earlier block of the same loop chose, possibly a number."""
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
    return any(is_constant(each) for each in arms_of(phi).values())


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
    """Return `routine` with each block that sets a tested number led past the tests of it, loop by loop."""
    if not tests:
        return routine
    flow = ControlFlow(routine)
    ways = CopiedWays(
        flow,
        is_past=lambda block, _way: block.label in tests,
        goes_on=lambda _found: True,  # what is known of other numbers may lead past other tests
        short_ways=partial(_short_ways, flow),
        ending="so",
    )
    loops = {loop.header if (loop := flow.innermost(each)) else "": loop for each in sorted(tests)}
    for loop in loops.values():
        inside = [label for label in flow.order if flow.innermost(label) is loop]
        asked = [_tested(flow, flow.blocks[label]) for label in inside if label in tests]
        behind = set(inside) - {loop.header if loop else ""}
        passed = behind & tests
        variables = {each.operands[-1] for each in asked if each is not None and each.opcode == "load"}
        ways.lead(inside, flow.blocks_before(passed, passed, behind), copied_to(flow, variables))
    return ways.routine()


def _short_ways(flow: ControlFlow, nodes: Mapping[Node, Ways], first: Node) -> set[Node]:
    """A path is copied up to a test, which GCC does not copy, unless that is too much code."""
    cost = {node: _cost(flow, each) for node, each in nodes.items()}
    ahead = {node: {(way, of.known) for way in of.ways} & nodes.keys() for node, of in nodes.items()}
    back: dict[Node, set[Node]] = {node: set() for node in nodes}
    for node, ways in ahead.items():
        for way in ways:
            back[way].add(node)
    up_to = _least([first] if first in nodes else [], ahead, cost)
    from_here = _least([node for node, each in nodes.items() if each.is_past], back, cost)
    return {
        node
        for node in up_to.keys() & from_here.keys()
        if up_to[node] + from_here[node] - cost[node] <= MOST_ON_A_WAY
    }


def _least(ends: Iterable[Node], ways: Mapping[Node, set[Node]], cost: Mapping[Node, int]) -> dict[Node, int]:
    """The least cost of a path from the ends to each node, both included, unless that is too much."""
    found = {node: cost[node] for node in ends}
    waiting = [*found]
    while waiting:
        node = waiting.pop()
        for each in ways[node]:
            if found[node] + cost[each] < found.get(each, MOST_ON_A_WAY + 1):
                found[each] = found[node] + cost[each]
                waiting.append(each)
    return found


def _cost(flow: ControlFlow, of: Ways) -> int:
    """The cost of a copy of a block, without accesses to variables, and without the test at its end if its answer is known."""
    rows = [each for each in of.block.instructions if not _is_free(flow, each)]
    decides = sum(each.opcode in ("icmp", "br") for each in rows[-2:])
    return len(rows) - (decides if len(of.ways) == 1 else 0)


def _is_free(flow: ControlFlow, each: Instruction) -> bool:
    if each.opcode in ("load", "store"):
        place = flow.instruction(each.operands[-1])
        return place is not None and place.opcode == "alloca"
    return each.opcode in CONVERSIONS
