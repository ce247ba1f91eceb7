"""Chains of tests for single numbers, turned into jumps by a table [gimple-if-to-switch.cc, `jump_table_cluster` in tree-switch-conversion.cc of GCC 12].

In `if state == 1: ..., elif state == 2: ...`, a block that does more than test, as the first one mostly does, is not
part of the chain.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from itertools import takewhile

from bfsim.kernel.estimate.conditions.number_tests import NumberTest, chains
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import come_to_from, put_between
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine

FEWEST_CASES = 5
"""[default_case_values_threshold in targhooks.cc, where the target has no `casesi`]"""
MOST_ENTRIES = 8
"""Most entries of a table for each comparison that it replaces [param_jump_table_max_growth_ratio_for_speed]."""
SMALL = 2
"""A table whose first case is at most this begins at 0, which saves a subtraction [emit_case_dispatch_table in stmt.cc]."""
MARK = ".case"
"""Ends the labels of a chain's blocks: GCC decides which they are before most of its other passes. LLVM may add a number to it.

A chain stays a table even if later passes leave fewer of its tests [pass_lower_switch is before vrp2 and threadfull2 in
passes.def].
"""


def has_table(flow: ControlFlow, tests: Sequence[NumberTest]) -> bool:
    """Whether a jump to one of these cases is made by a table; neighbouring numbers that lead to one place are one case."""
    plain = {each.hit for each in tests if flow.blocks[each.hit].instructions[0].opcode != "phi"}
    runs: list[list[NumberTest]] = []
    for each in sorted(tests, key=lambda each: each.number):
        if (
            runs
            and each.hit in plain
            and each.hit == runs[-1][-1].hit
            and each.number == runs[-1][-1].number + 1
        ):
            runs[-1].append(each)
        else:
            runs.append([each])
    comparisons = sum(min(2, len(each)) for each in runs)
    entries = runs[-1][-1].number - runs[0][0].number + 1
    return len(runs) >= FEWEST_CASES and entries <= MOST_ENTRIES * comparisons


def first_entry(numbers: Collection[int]) -> int:
    """Return the number of a table's first entry."""
    return 0 if 0 < min(numbers) <= SMALL else min(numbers)


def with_jump_tables(routine: Routine) -> Routine:
    """Return `routine` with a `switch` in place of each such chain."""
    flow = ControlFlow(routine)
    blocks = dict(flow.blocks)
    for chain in chains(flow, lambda block: MARK in block.label):
        _switch(blocks, list(takewhile(lambda each: MARK in each.label, chain)))
    return replace(routine, blocks=tuple(blocks.values()))


def _switch(blocks: dict[str, BasicBlock], chain: Sequence[NumberTest]) -> None:
    """Let the first block of a chain switch; the others go on to their targets, so that phis there need not change."""
    first, otherwise = chain[0], chain[-1].other
    branch = blocks[first.label].terminator
    conversions = [row for each in chain for row in blocks[each.label].instructions[:-2]]
    way = first.hit
    if way == otherwise:  # a phi there has one value from each block
        way = f"{first.label}{MARK}"
        put_between(blocks, first.label, otherwise, way)
    ways = [way, *(each.label for each in chain[1:])]
    kind = f"i{first.bits}"
    cases = " ".join(f"{kind} {each.number}, label %{way}" for each, way in zip(chain, ways, strict=True))
    text = f"switch {kind} {first.value}, label %{otherwise} [ {cases} ]"
    switch = Instruction(None, "switch", text, (first.value,), branch.line, location=branch.location)
    blocks[first.label] = replace(blocks[first.label], instructions=(*conversions, switch))
    blocks[otherwise] = come_to_from(blocks[otherwise], chain[-1].label, first.label)
    for each in chain[1:]:
        end = blocks[each.label].terminator
        jump = Instruction(None, "br", f"br label %{each.hit}", (), end.line, location=end.location)
        blocks[each.label] = replace(blocks[each.label], instructions=(jump,))
