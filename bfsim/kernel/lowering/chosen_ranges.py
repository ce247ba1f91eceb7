"""Two tests for a range that only choose between two values are made one, so that a conditional move can choose [ifcvt.cc of GCC 12].

Of `if -30 < v and v < 30: v = 0` the range is one test to GCC (`ranges`), and no way leads from between the two.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir_text import BasicBlock, Instruction, Routine, arms_of, predicate, written
from bfsim.kernel.loops import ControlFlow
from bfsim.kernel.lowering.edges import come_to_from, without_way
from bfsim.kernel.lowering.number_tests import come_alike
from bfsim.kernel.lowering.ranges import Range, ranges
from bfsim.kernel.lowering.widths import WORD


def with_chosen_ranges(routine: Routine) -> Routine:
    """Return `routine` with such tests made one."""
    while True:
        flow = ControlFlow(routine)
        found = (
            each for label, each in ranges(flow, frozenset(), neighbours=False).items() if label == each.first
        )
        chosen = next((each for each in found if _only_chooses(flow, each)), None)
        if chosen is None:
            return routine
        routine = replace(routine, blocks=tuple(_joined(flow, chosen).values()))


def _only_chooses(flow: ControlFlow, tested: Range) -> bool:
    """Whether both tests are of one value, and decide what one phi behind them is, and nothing else."""
    first, second = (_test(flow, label) for label in (tested.first, tested.second))
    outside = _outside(flow, tested)
    are_here = (
        first in flow.blocks[tested.first].instructions and second in flow.blocks[tested.second].instructions
    )
    if (
        not are_here
        or first.operands[0] != second.operands[0]
        or {*flow.blocks[tested.first].successors} != {tested.second, outside}
    ):
        return False
    arms = [way for way in (tested.inside, outside) if _is_arm(flow, way, {tested.first, tested.second})]
    homes = {flow.blocks[way].successors[0] if way in arms else way for way in (tested.inside, outside)}
    if not arms or len(homes) != 1:
        return False
    home = homes.pop()
    sources = [way if way in arms else tested.second for way in (tested.inside, outside)]
    phis = [arms_of(each) for each in flow.blocks[home].instructions if each.opcode == "phi"]
    chosen = [each for each in phis if each[sources[0]] != each[sources[1]]]
    return len(chosen) == 1 and (outside != home or come_alike(flow, home, (tested.first, tested.second)))


def _outside(flow: ControlFlow, tested: Range) -> str:
    return next(way for way in flow.blocks[tested.second].successors if way != tested.inside)


def _test(flow: ControlFlow, label: str) -> Instruction:
    """The comparison that decides at the end of a block."""
    return flow.defined[flow.blocks[label].terminator.operands[0]][1]


def _is_arm(flow: ControlFlow, way: str, tests: set[str]) -> bool:
    """Whether a block does nothing on the way from the tests."""
    block = flow.blocks[way]
    is_empty = len(block.instructions) == 1 and len(block.successors) == 1 and not block.enters
    return is_empty and tests >= {*flow.predecessors[way]}


def _joined(flow: ControlFlow, tested: Range) -> dict[str, BasicBlock]:
    """Return the blocks of the routine, of which the first makes the test, and the second is none any more."""
    blocks, outside = dict(flow.blocks), _outside(flow, tested)
    first, second, branch = (
        blocks[tested.first],
        blocks.pop(tested.second),
        flow.blocks[tested.first].terminator,
    )
    gone = (_test(flow, first.label), _test(flow, second.label))
    kept = [row for block in (first, second) for row in block.instructions[:-1] if row not in gone]
    rows = _range_test(tested, gone[0], branch)
    text = f"br i1 {rows[-1].result}, label %{tested.inside}, label %{outside}"
    end = replace(branch, text=text, operands=(rows[-1].result or "",), weights=(), hint="")
    blocks[first.label] = replace(first, instructions=(*kept, *rows, end))
    ways = (without_way(each, second.label) for each in blocks[outside].instructions)
    blocks[outside] = replace(blocks[outside], instructions=tuple(ways))
    blocks[tested.inside] = come_to_from(blocks[tested.inside], second.label, first.label)
    return blocks


def _range_test(tested: Range, test: Instruction, branch: Instruction) -> list[Instruction]:
    """Return what tests a word for a range: no more than its size from the least number."""
    value, rows = test.operands[0], list[Instruction]()

    def row(name: str, text: str, *operands: str) -> str:
        rows.append(written(f"%{tested.first}.{name}", text, operands, branch))
        return f"%{tested.first}.{name}"

    if test.bits < WORD:
        extension = "sext" if predicate(test).startswith("s") else "zext"
        value = row("word", f"{extension} i{test.bits} {value} to i{WORD}", value)
    if tested.low:
        value = row("above", f"add i{WORD} {value}, {-tested.low}", value, str(-tested.low))
    size = str(tested.high - tested.low + 1)
    row("within", f"icmp ult i{WORD} {value}, {size}", value, size)
    return rows
