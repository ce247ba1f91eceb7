"""Chains of tests that only choose constants, turned into loads from tables [`switch_conversion` in tree-switch-conversion.cc of GCC 12]."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

from bfsim.kernel.estimate.conditions.number_tests import NumberTest
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import come_to_from
from bfsim.kernel.ir.text import BasicBlock, Instruction, arms_of, is_number, with_values, written

Values = dict[str, dict[int, int]]
"""For each phi after a chain, its value for each number."""


def chosen(flow: ControlFlow, chain: Sequence[NumberTest]) -> tuple[str, Values] | None:
    """Return the block after a chain, and the values of its phis, if the chain only chooses between more than two constants.

    Numbers between those of the chain get the value of the default, so if there are any, that must be a constant, too.
    """
    labels = {each.label for each in chain}
    ways = {each.number: _landing(flow, labels, each.label, each.hit) for each in chain}
    ends = {end for end, _ in ways.values()}
    if len(ends) != 1:
        return None
    (end,) = ends
    low, high = min(ways), max(ways)
    gaps = set(range(low, high + 1)) - ways.keys()
    if gaps:
        otherwise = _landing(flow, labels, chain[-1].label, chain[-1].other)
        if otherwise[0] != end:
            return None
        ways |= dict.fromkeys(gaps, otherwise)
    values: Values = {}
    for phi in flow.blocks[end].instructions:
        if phi.opcode == "phi":
            arms = arms_of(phi)
            found = {number: arms[label] for number, (_, label) in ways.items()}
            if not all(map(is_number, found.values())) or not phi.text.startswith("phi i32"):
                return None
            values[phi.result or ""] = {number: int(value) for number, value in found.items()}
    distinct = max((len(set(each.values())) for each in values.values()), default=0)
    return (end, values) if distinct > 2 else None


def _landing(flow: ControlFlow, labels: set[str], label: str, way: str) -> tuple[str, str]:
    """Return where a path ends, and from which block it comes there: an empty block to which only `labels` lead is skipped."""
    block = flow.blocks[way]
    is_empty = len(block.instructions) == 1 and len(block.successors) == 1 and not block.enters
    return (block.successors[0], way) if is_empty and labels >= {*flow.predecessors[way]} else (way, label)


def load_chosen(
    flow: ControlFlow, blocks: dict[str, BasicBlock], chain: Sequence[NumberTest], end: str, values: Values
) -> Iterator[str]:
    """Replace a chain that only chooses by a load; return the tables, as LLVM's definitions."""
    first, last = chain[0], chain[-1]
    branch = blocks[first.label].terminator
    name, low = f"{first.label}.table", min(each.number for each in chain)
    size = max(each.number for each in chain) - low + 1

    def row(result: str, text: str, *operands: str) -> Instruction:
        return written(result, text, operands, branch)

    index, near = f"%{first.label}.index", f"%{first.label}.near"
    rows = [each for one in chain for each in blocks[one.label].instructions[:-2]]
    rows.append(row(index, f"add i32 {first.value}, {-low}", first.value, str(-low)))
    rows.append(row(near, f"icmp ult i32 {index}, {size}", index, str(size)))
    goes = replace(
        branch,
        text=f"br i1 {near}, label %{name}, label %{last.other}",
        operands=(near,),
        weights=(),
        hint="",
    )
    blocks[first.label] = replace(blocks[first.label], instructions=(*rows, goes))
    loads, brought = [], dict[str, str]()
    symbol = f"@{flow.routine.symbol}.{name}"
    for number, (phi, of) in enumerate(values.items()):
        words = ", ".join(f"i32 {of[each]}" for each in range(low, low + size))
        yield f"{symbol}{number} = private unnamed_addr constant [{size} x i32] [{words}]"
        place, found = f"%{name}.place{number}", f"%{name}{number}"
        loads.append(
            row(place, f"getelementptr i32, ptr {symbol}{number}, i32 {index}", f"{symbol}{number}", index)
        )
        loads.append(row(found, f"load i32, ptr {place}, align 4", place))
        brought[phi] = found
    jump = Instruction(None, "br", f"br label %{end}", (), branch.line, location=branch.location)
    blocks[name] = BasicBlock(name, (*loads, jump))
    labels = {each.label for each in chain}
    come = {_landing(flow, labels, each.label, each.hit)[1] for each in chain}
    blocks[end] = _come_to(blocks[end], come, name, brought)
    blocks[last.other] = come_to_from(blocks[last.other], last.label, first.label)
    for each in (come | labels) - {first.label}:
        del blocks[each]


def _come_to(block: BasicBlock, come: Collection[str], name: str, brought: Mapping[str, str]) -> BasicBlock:
    """Return a block whose phis take the values that a table has `brought`, in place of those from several blocks."""
    rows = []
    for each in block.instructions:
        if each.opcode == "phi":
            arms = {label: arm for label, arm in arms_of(each).items() if label not in come}
            arms[name] = brought[each.result or ""]
            rows.append(with_values(each, arms))
        else:
            rows.append(each)
    return replace(block, instructions=tuple(rows))
