"""Hints of the source, which move with threaded jumps: `if not is_digit(c): continue`, where `is_digit` is inlined.

GCC 12 guesses after early inlining and threading: a `continue` makes each edge unlikely that leads only to it
[predict_paths_leading_to in predict.cc]. LLVM's hint is lost with its branch, because that tests a number that each
path to it knows. So the hint moves to the branches at which those paths part.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.ir.text import NO_HINT, BasicBlock, Instruction, Routine, arms_of, predicate
from bfsim.kernel.ir.writing import with_names, write_module


def with_threaded_hints(text: str) -> str:
    """Return the module `text`, whose variables are registers and to which nothing else was done yet, with such hints moved."""
    if "branch_weights" not in text:
        return text
    text = with_names(text)
    return write_module(
        text, [_hinted(routine, _moved(ControlFlow(routine))) for routine in read_module(text)]
    )


def _hinted(routine: Routine, moved: dict[str, tuple[int, ...]]) -> Routine:
    def hinted(block: BasicBlock) -> BasicBlock:
        if block.label not in moved:
            return block
        branch = replace(block.terminator, weights=moved[block.label], hint="")
        return replace(block, instructions=(*block.instructions[:-1], branch))

    return replace(routine, blocks=tuple(map(hinted, routine.blocks)))


def _moved(flow: ControlFlow) -> dict[str, tuple[int, ...]]:
    """For each branch that gets a hint: how likely each side is, by its label."""
    found = dict[str, tuple[int, ...]]()
    given = {block.label: block.terminator.weights for block in flow.routine.blocks}
    waiting = [label for label, weights in given.items() if _is_hint(weights)]
    while waiting:
        label = waiting.pop()
        weights = found.get(label, given[label])
        for before, way in _ways_to_the_rarer_side(flow, flow.blocks[label], weights[0] < weights[1]):
            if before not in found and not _is_hint(given[before]):
                found[before] = tuple(sorted(weights, reverse=flow.blocks[before].successors[0] != way))
                waiting.append(before)
    return found


def _is_hint(weights: tuple[int, ...]) -> bool:
    return len(set(weights)) > 1 and set(weights) != set(NO_HINT)


def _ways_to_the_rarer_side(flow: ControlFlow, block: BasicBlock, holds: bool) -> Iterator[tuple[str, str]]:
    """Branches, and their sides, from which the result of the test that ends `block` is certain."""
    tested = _tested(flow, block)
    if tested is None:
        return
    phi, if_set = tested
    for label, value in arms_of(phi).items():
        edge = _parting(flow, label, block.label)
        if edge is None:
            continue
        before, way = edge
        is_condition = value in flow.blocks[before].terminator.operands
        known = str(int(flow.blocks[before].successors[0] == way)) if is_condition else value
        if not known.startswith("%") and (known not in ("0", "false")) == (if_set == holds):
            yield edge


def _tested(flow: ControlFlow, block: BasicBlock) -> tuple[Instruction, bool] | None:
    """The phi of numbers that a branch tests in its block, and whether it holds if that is not 0."""
    name, if_set = (*block.terminator.operands[:1], "")[0], True
    while (test := flow.instruction(name)) is not None:
        if test.opcode == "xor" and test.bits == 1:
            if_set = not if_set
        elif test.opcode == "icmp" and predicate(test) in ("eq", "ne") and test.operands[1] == "0":
            if_set = if_set == (predicate(test) == "ne")
        else:
            break
        name = test.operands[0]
    is_phi = test is not None and test.opcode == "phi" and flow.defined[name][0] == block.label
    return (test, if_set) if test is not None and is_phi else None


def _parting(flow: ControlFlow, label: str, way: str) -> tuple[str, str] | None:
    """The branch, and its side, from which only one path leads to `way` through block `label`."""
    while len(set(flow.blocks[label].successors)) == 1:
        if len(flow.blocks[label].instructions) > 1 or len(flow.predecessors[label]) != 1:
            return None
        label, way = flow.predecessors[label][0], label
    return (label, way) if flow.blocks[label].terminator.opcode == "br" else None
