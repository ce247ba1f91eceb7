"""Chains of tests that GCC turns into a `switch`, before most of its other passes [gimple-if-to-switch.cc of GCC 12].

Other modules say what they become: a jump by a table (`jump_tables`), a load from one (`constant_tables`), or paths
that lead past the tests (`state_machines`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import llvmlite.binding as llvm

from bfsim.kernel.estimate.conditions.direct_conditions import with_direct_conditions
from bfsim.kernel.estimate.conditions.number_tests import chains, is_alone
from bfsim.kernel.estimate.switches.constant_tables import chosen, load_chosen
from bfsim.kernel.estimate.switches.hidden_numbers import DECLARED, hide
from bfsim.kernel.estimate.switches.jump_tables import MARK, has_table
from bfsim.kernel.estimate.switches.state_machines import with_state_machines
from bfsim.kernel.ir import llvm_passes
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import come_to_from, going_to
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.ir.text import HIDES, BasicBlock, Routine
from bfsim.kernel.ir.widths import WORD
from bfsim.kernel.ir.writing import with_names, write_module
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule

MOST_BLOCKS = 100
"""[ours] If a routine has more blocks, no paths are copied in its module: LLVM's value numbering gives up on the result."""


def with_switches(module: llvm.ModuleRef, profile: CompilerProfile) -> llvm.ModuleRef:
    """Return a module with such chains marked, or replaced, and paths past them; the module itself if there are none."""
    text = with_names(str(module))
    tables = list[str]()
    marked = write_module(text, [_marked(each, tables, profile) for each in read_module(text)])
    if HIDES not in marked and not tables:
        return module
    if HIDES not in marked:
        return llvm.parse_assembly("\n".join((marked, *tables)))
    module = llvm.parse_assembly("\n".join((marked, *tables, DECLARED)))
    is_large = any(len(each.blocks) > MOST_BLOCKS for each in read_module(marked))
    return module if is_large or not profile.applies(Rule.STATE_MACHINES) else _threaded(module)


def _threaded(module: llvm.ModuleRef) -> llvm.ModuleRef:
    llvm_passes.run(("register_to_memory",), module)
    text = with_names(str(module))
    text = write_module(text, [with_state_machines(each) for each in read_module(text)])
    module = llvm.parse_assembly(text)
    llvm_passes.run(("sroa", "simplify_cfg"), module)
    return module


def _marked(routine: Routine, tables: list[str], profile: CompilerProfile) -> Routine:
    """Return `routine` with its chains marked; those that only choose constants become loads from `tables`, to which theirs are added."""
    flow = ControlFlow(with_direct_conditions(routine))
    switches = [each for each in chains(flow, is_alone) if has_table(flow, each) and each[0].bits == WORD]
    if not switches:
        return routine
    blocks, names = dict(flow.blocks), dict[str, str]()
    chosen_by = [chosen(flow, each) if profile.applies(Rule.CONSTANT_TABLES) else None for each in switches]
    for chain, only in zip(switches, chosen_by, strict=True):
        if only is None:
            names |= {each.label: f"{each.label}{MARK}" for each in chain}
            hide(flow, blocks, chain[0].value, chain[0].label)
    for chain, only in zip(switches, chosen_by, strict=True):
        if only is not None:
            tables += load_chosen(flow, blocks, chain, *only)
    return replace(routine, blocks=tuple(_renamed(each, names) for each in blocks.values()))


def _renamed(block: BasicBlock, names: Mapping[str, str]) -> BasicBlock:
    """Return a block with some blocks renamed."""
    for old in {*block.successors} & names.keys():
        block = going_to(block, old, names[old])
    for old, new in names.items():
        block = come_to_from(block, old, new)
    return replace(block, label=names.get(block.label, block.label))
