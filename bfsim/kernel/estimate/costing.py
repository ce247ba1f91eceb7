"""Costs a kernel: its code for a fixed generic target, what is counted in a run of it, and what that costs.

This decides what the Blackfin would run and must not depend on the host. It is kept apart from the machine code: the linker
asks for the size of kernels that are never called, and every build of a kernel has the same costs.
"""

from __future__ import annotations

from functools import cache

import llvmlite.binding as llvm

from bfsim.kernel.costs.charges import Access, merged
from bfsim.kernel.costs.costs import Costs
from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.costs.routine_calls import calls_of
from bfsim.kernel.emitting.emit import emit
from bfsim.kernel.emitting.narrowed_divisions import with_rounded_names
from bfsim.kernel.estimate import optimised as optimising
from bfsim.kernel.estimate.inlining.inlining import inlined_calls
from bfsim.kernel.estimate.jump_threading.first_iterations import with_first_iterations
from bfsim.kernel.estimate.jump_threading.kept_bounds import with_kept_bounds
from bfsim.kernel.estimate.jump_threading.known_entries import with_known_entries
from bfsim.kernel.estimate.jump_threading.skipped_iterations import with_skipped_iterations
from bfsim.kernel.estimate.jump_threading.threaded_choices import with_threaded_choices
from bfsim.kernel.estimate.jump_threading.threaded_hints import with_threaded_hints
from bfsim.kernel.estimate.loop_copies.rotations import held, released
from bfsim.kernel.estimate.loop_copies.unrolled import marked
from bfsim.kernel.estimate.rewrites import rewritten, rewritten_early, rewritten_last
from bfsim.kernel.estimate.switches.hidden_numbers import revealed
from bfsim.kernel.estimate.switches.switches import with_switches
from bfsim.kernel.estimate.unoptimised import lowering as unoptimised
from bfsim.kernel.ir import llvm_passes
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.reading import inlined_through, read_module
from bfsim.kernel.ir.text import HIDES, Entrance, Routine, SourceLine, without_marks
from bfsim.kernel.language.function import Function
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule

UNROLLED_NESTING = 3  # loops in loops that are written out, the inner ones first
CLEANING = (
    "instruction_combine", "new_gvn", "simplify_cfg", "instruction_combine", "aggressive_dce", "simplify_cfg",
)  # fmt: skip
PASSES = (
    "simplify_cfg", "jump_threading", "simplify_cfg", "instruction_combine", "loop_simplify", "lcssa",
)  # fmt: skip
"""Before loops are rotated."""
ROTATED_PASSES = (
    "new_gvn",
    "jump_threading",
    "instruction_combine",
    "simplify_cfg",
    "loop_simplify",
    "lcssa",
)
"""Behind that."""
LATER_PASSES = ("jump_threading", *CLEANING)
"""Behind a second rotation: of the loops that jump threading has made."""
REVEALED_PASSES = ("jump_threading", "instruction_combine", "simplify_cfg", "aggressive_dce", "simplify_cfg")
"""Where numbers were hidden: LLVM's value numbering would give up on what now comes together."""


def costed(function: Function, profile: CompilerProfile) -> Costs:
    """Cost `function` and its callees."""
    text = optimised(function, profile)
    routines = tuple(map(without_marks, read_module(text)))
    counters = tuple(each for routine in routines for each in cost(routine, profile))
    return Costs(counters, calls_of(routines), inlined_through(text))


@cache
def optimised(function: Function, profile: CompilerProfile) -> str:
    """Return the optimised IR of `function` and its callees: the code that is costed and counted."""
    inlined = inlined_calls(function, profile)
    module = llvm_passes.parsed(emit(function, inlined, one_way_back=profile.optimises))
    if not profile.optimises:
        return str(module)
    if inlined:
        _inline(module, function)
    llvm_passes.run(("sroa",), module)
    if inlined and profile.applies(Rule.THREADED_HINTS):
        module = llvm.parse_assembly(with_threaded_hints(str(module)))
    llvm_passes.run(("simplify_cfg",), module)
    module = llvm.parse_assembly(rewritten_early(str(module), profile))
    if profile.applies(Rule.JUMP_TABLES):
        module = with_switches(module, profile)
    if profile.applies(Rule.THREADED_CHOICES):
        module = with_threaded_choices(module)
    llvm_passes.run(PASSES, module)
    module = _rotated(module, profile, before=True)
    llvm_passes.run(ROTATED_PASSES, module)
    module = _rotated(module, profile)
    llvm_passes.run(LATER_PASSES, module)
    text = str(module)
    if HIDES in text:  # what can no longer come to a table is known now
        module = llvm.parse_assembly(revealed(text))
        llvm_passes.run(REVEALED_PASSES, module)
        text = str(module)
    if profile.applies(Rule.SKIPPED_ITERATIONS):
        text = with_skipped_iterations(with_rounded_names(text, function))
    for _ in range(UNROLLED_NESTING):
        if (unrolling := marked(text, guesses=profile.applies(Rule.LOOP_GUARDS))) is None:
            break
        module = llvm.parse_assembly(unrolling)
        llvm_passes.run(("loop_unroll", *CLEANING), module)
        text = str(module)
    text = _threaded(rewritten(with_rounded_names(text, function), profile), profile)
    return rewritten_last(text, profile)


def _threaded(text: str, profile: CompilerProfile) -> str:
    """Thread jumps behind all other passes."""
    if profile.applies(Rule.KEPT_BOUNDS):
        text = with_kept_bounds(text)
    if not profile.applies(Rule.FIRST_ITERATIONS):
        return text
    return with_known_entries(with_first_iterations(text, profile))


def _rotated(module: llvm.ModuleRef, profile: CompilerProfile, *, before: bool = False) -> llvm.ModuleRef:
    """Rotate loops, first or once more; those that end with their test already stay as they are."""
    rule = Rule.STEPPED_BEFORE if before else Rule.ROTATED_ONCE
    holding = held(str(module), before=before) if profile.applies(rule) else None
    if holding is not None:
        module = llvm.parse_assembly(holding)
    llvm_passes.run(("loop_rotate",), module)
    return module if before else llvm.parse_assembly(released(str(module)))


def _inline(module: llvm.ModuleRef, function: Function) -> None:
    """Inline the calls that are marked, and leave out what nothing calls any more, as a linker does."""
    defined = [each for each in module.functions if not each.is_declaration and each.name != function.symbol]
    for each in defined:
        each.linkage = "internal"
    llvm_passes.run(("always_inliner", "global_dead_code_eliminate"), module)
    for each in module.functions:
        if not each.is_declaration:
            each.linkage = "external"


def cost(routine: Routine, profile: CompilerProfile) -> tuple[Counter, ...]:
    """Cost every block of `routine`; one counter per block, and one per branch whose sides cost differently."""
    lower = optimising.lower if profile.optimises else unoptimised.lower
    blocks = lower(routine, profile)
    flow = ControlFlow(routine)
    known = _accesses(flow)
    counters: list[Counter] = []
    for block in routine.blocks:
        found = blocks[block.label]
        place, depth = (routine.symbol, block.label), len(flow.loops_of(block.label))
        charges = merged(found.charges)
        accesses = (
            *(known[id(each)] for each in found.accesses if id(each) in known),
            *(known[id(each)]._replace(fills=True) for each in found.fills),
        )
        own = Entrance(routine.symbol, SourceLine(routine.symbol, 0))
        enters = (*([own] if block is routine.blocks[0] else []), *block.enters)
        if not charges and not accesses and not found.tests and not enters:
            continue  # nothing to count: the block holds no code
        counters.append(Counter(*place, None, None, charges, accesses, found.nbytes, depth, enters))
        for test in found.tests:
            charges = merged(test.charges)
            if any(each.issue_cclk for each in charges):
                counters.append(Counter(*place, test.value, test.equals, charges, (), 0, depth))
    return tuple(counters)


def _accesses(flow: ControlFlow) -> dict[int, Access]:
    """Every load and store of a routine, by the identity of its instruction; a compiler's own table is no array of the kernel."""
    found = {}
    for block in flow.routine.blocks:
        rows = (each for each in block.instructions if each.opcode in ("load", "store"))
        for number, each in enumerate(rows):
            root = flow.root(each.operands[-1])
            if not root.startswith("@"):
                found[id(each)] = Access(root[1:], each.opcode == "store", block.label, number, each.line)
    return found
