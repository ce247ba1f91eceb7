"""Edges of the control flow: a branch that goes elsewhere, phis that come from elsewhere, a block between two."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import replace

from bfsim.kernel.ir.text import BasicBlock, Instruction, arms_of, each_arm, with_each_arm, with_values


def going_to(block: BasicBlock, old: str, new: str) -> BasicBlock:
    """Return a block that goes to `new` in place of `old`."""
    *rows, end = block.instructions
    text = re.sub(rf"label %{re.escape(old)}(?![\w.$-])", f"label %{new}", end.text)
    return replace(block, instructions=(*rows, replace(end, text=text)))


def come_to_from(block: BasicBlock, old: str, new: str) -> BasicBlock:
    """Return a block whose phis expect `new` where they expected `old`."""
    rows = [
        replace(each, text=each.text.replace(f", %{old} ]", f", %{new} ]")) if each.opcode == "phi" else each
        for each in block.instructions
    ]
    return replace(block, instructions=tuple(rows))


def without_way(phi: Instruction, label: str) -> Instruction:
    """Return a phi without its value from block `label`; any other instruction as it is."""
    if phi.opcode != "phi":
        return phi
    return with_values(phi, {way: value for way, value in arms_of(phi).items() if way != label})


def put_between(blocks: dict[str, BasicBlock], source: str, label: str, between: str) -> None:
    """Put an empty block on the edge from block `source` to block `label`."""
    branch = blocks[source].terminator
    jump = Instruction(None, "br", f"br label %{label}", (), branch.line, location=branch.location)
    blocks[source] = going_to(blocks[source], label, between)
    blocks[label] = come_to_from(blocks[label], source, between)
    blocks[between] = BasicBlock(between, (jump,))


def join_before(blocks: dict[str, BasicBlock], sources: list[str], label: str, between: str) -> None:
    """Put one empty block on the edges from all of `sources` to block `label`, by which the same values come to its phis."""
    first, *others = sources
    put_between(blocks, first, label, between)
    for each in others:
        blocks[each] = going_to(blocks[each], label, between)
        blocks[label] = replace(
            blocks[label], instructions=tuple(without_way(row, each) for row in blocks[label].instructions)
        )


def bypass(blocks: dict[str, BasicBlock], before: list[str], label: str, end: str) -> None:
    """Make all that goes to an empty block go to where that leads."""
    for each in before:
        *rows, branch = blocks[each].instructions
        text = re.sub(rf"label %{re.escape(label)}(?![\w.$-])", f"label %{end}", branch.text)
        blocks[each] = replace(blocks[each], instructions=(*rows, replace(branch, text=text)))
    changed = []
    for phi in blocks[end].instructions:
        if phi.opcode == "phi":
            arms = each_arm(phi)
            ways = [(value, source) for value, source in arms if source != label]
            ways += [(value, each) for value, source in arms if source == label for each in before]
            changed.append(with_each_arm(phi, ways))
        else:
            changed.append(phi)
    blocks[end] = replace(blocks[end], instructions=tuple(changed))
    del blocks[label]


def with_arms(block: BasicBlock, gone: Collection[str], labels: Iterable[str]) -> BasicBlock:
    """Return a block that is entered from `labels` instead of the blocks that are `gone`, which all bring the same values."""
    rows = []
    for phi in block.instructions:
        if phi.opcode == "phi":
            arms = arms_of(phi)
            value = next(arms[each] for each in gone if each in arms)
            ways = {each: arm for each, arm in arms.items() if each not in gone} | dict.fromkeys(
                labels, value
            )
            rows.append(with_values(phi, ways))
        else:
            rows.append(phi)
    return replace(block, instructions=tuple(rows))
