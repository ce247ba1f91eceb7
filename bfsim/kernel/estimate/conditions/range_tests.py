"""Two tests of one condition for a range, joined from the start, before any jump is threaded past one of them [fold_range_test in fold-const.cc of GCC 12].

`48 <= c and c <= 57` is `(unsigned) c - 48 <= 9`: if it does not hold, nothing more is known of c.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from bfsim.kernel.estimate.conditions.direct_conditions import with_direct_conditions
from bfsim.kernel.estimate.conditions.joined_tests import Range, ranges
from bfsim.kernel.estimate.conditions.number_tests import come_alike
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import come_to_from, without_way
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, renamed, written
from bfsim.kernel.ir.widths import WORD


def with_range_tests(routine: Routine) -> Routine:
    """Return `routine` with such tests joined."""
    routine = with_direct_conditions(routine)
    while True:
        flow = ControlFlow(routine)
        found = ranges(flow, frozenset(), neighbours=False).items()
        joined = next((each for label, each in found if label == each.first and _may_join(flow, each)), None)
        if joined is None:
            return routine
        routine = replace(routine, blocks=tuple(_joined(flow, joined).values()))


def _may_join(flow: ControlFlow, tested: Range) -> bool:
    """Whether both tests are of a value, and lead to one place if they fail, as if they were one."""
    outside = _outside(flow, tested)
    leads = {*flow.blocks[tested.first].successors} == {tested.second, outside}
    _, test = flow.defined[flow.blocks[tested.first].terminator.operands[0]]
    is_of_value = any(each.startswith("%") for each in test.operands)  # `3 < 5` is none
    return leads and is_of_value and come_alike(flow, outside, (tested.first, tested.second))


def _outside(flow: ControlFlow, tested: Range) -> str:
    return next(way for way in flow.blocks[tested.second].successors if way != tested.inside)


def _joined(flow: ControlFlow, tested: Range) -> dict[str, BasicBlock]:
    """Return the blocks of the routine; the first makes the test, and the second is gone."""
    blocks, outside = dict(flow.blocks), _outside(flow, tested)
    first, second = blocks[tested.first], blocks.pop(tested.second)
    branch = second.terminator
    gone = [flow.defined[each.terminator.operands[0]][1] for each in (first, second)]
    kept = [row for block in (first, second) for row in block.instructions[:-1] if row not in gone]
    rows = _range_test(tested, gone[0], branch, "ult" if second.successors[0] == tested.inside else "uge")
    end = renamed(branch, {branch.operands[0]: rows[-1].result or ""})
    blocks[first.label] = replace(first, instructions=(*kept, *rows, end))
    ways = (without_way(each, second.label) for each in blocks[outside].instructions)
    blocks[outside] = replace(blocks[outside], instructions=tuple(ways))
    blocks[tested.inside] = come_to_from(blocks[tested.inside], second.label, first.label)
    again = dict.fromkeys(_repeated(flow, tested, rows[0]), rows[0].result or "")
    return {label: _without(each, again) for label, each in blocks.items()} if again else blocks


def _repeated(flow: ControlFlow, tested: Range, above: Instruction) -> Iterator[str]:
    """Values after a test that are the tested value less the least of the range, which the test computes [pass_fre in tree-ssa-sccvn.cc]."""
    value = above.operands[0]
    for each in flow.users[value] if above.opcode == "add" else ():
        label, _ = flow.defined.get(each.result or "", ("", None))
        is_same = (each.opcode, *each.operands) in (
            ("sub", value, str(tested.low)),
            ("add", value, str(-tested.low)),
        )
        if is_same and tested.first in flow.dominators[label]:
            yield each.result or ""


def _without(block: BasicBlock, again: Mapping[str, str]) -> BasicBlock:
    rows = (renamed(each, again) for each in block.instructions if each.result not in again)
    return replace(block, instructions=tuple(rows))


def _range_test(tested: Range, test: Instruction, branch: Instruction, relation: str) -> list[Instruction]:
    """Return the test of a value for a range: its distance from the least number is at most the size."""
    value, rows = next(each for each in test.operands if each.startswith("%")), list[Instruction]()

    def row(name: str, text: str, *operands: str) -> str:
        rows.append(written(f"%{tested.first}.{name}", text, operands, branch))
        return f"%{tested.first}.{name}"

    if tested.low:
        value = row("above", f"add i{WORD} {value}, {-tested.low}", value, str(-tested.low))
    size = str(tested.high - tested.low + 1)
    row("within", f"icmp {relation} i{WORD} {value}, {size}", value, size)
    return rows
