"""Rewrites of the optimised IR: what compilers for the Blackfin do beyond LLVM's passes that changes which accesses are made, and where.

What is costed, and what is compiled for the host and reports its accesses, is read from the text that they leave: it is one program.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from bfsim.kernel.estimate.arithmetic.common_factors import with_common_factors
from bfsim.kernel.estimate.arithmetic.even_addresses import with_even_addresses
from bfsim.kernel.estimate.arithmetic.factored_sums import factor_sums
from bfsim.kernel.estimate.arithmetic.remainders import with_remainders
from bfsim.kernel.estimate.arithmetic.saturations import without_saturations
from bfsim.kernel.estimate.arithmetic.shift_counts import with_wide_counts
from bfsim.kernel.estimate.arithmetic.shifted_bits import with_shifted_bits
from bfsim.kernel.estimate.arithmetic.shifted_products import with_shifted_products
from bfsim.kernel.estimate.arithmetic.strength_reduction import with_reduced_strength
from bfsim.kernel.estimate.arithmetic.subtractions import with_subtractions
from bfsim.kernel.estimate.arithmetic.summed_indices import with_summed_indices
from bfsim.kernel.estimate.choices.adjacent_numbers import with_adjacent_numbers
from bfsim.kernel.estimate.choices.clamps import with_clamps
from bfsim.kernel.estimate.choices.extremes import with_extremes
from bfsim.kernel.estimate.choices.known_values import with_known_values
from bfsim.kernel.estimate.choices.narrow_sides import with_narrow_sides
from bfsim.kernel.estimate.choices.narrow_sums import with_narrow_sums
from bfsim.kernel.estimate.choices.restored_values import with_restored_values
from bfsim.kernel.estimate.choices.same_truths import with_same_truths
from bfsim.kernel.estimate.choices.sides_apart import with_sides_apart
from bfsim.kernel.estimate.choices.sides_of_tests import with_operations_on_sides
from bfsim.kernel.estimate.choices.wide_extremes import widen_extremes
from bfsim.kernel.estimate.conditions.narrow_tests import with_narrow_tests
from bfsim.kernel.estimate.conditions.nearer_bounds import with_nearer_bounds
from bfsim.kernel.estimate.conditions.next_values import with_tests_of_next_values
from bfsim.kernel.estimate.conditions.range_tests import with_range_tests
from bfsim.kernel.estimate.conditions.shifted_tests import with_shifted_tests
from bfsim.kernel.estimate.conditions.short_circuits import split_tests
from bfsim.kernel.estimate.induction_variables.stepped_values import with_stepped_values
from bfsim.kernel.estimate.jump_threading.known_answers import with_known_answers
from bfsim.kernel.estimate.loop_copies.header_copies import copy_breaks, copy_headers
from bfsim.kernel.estimate.loops.final_values import with_final_values
from bfsim.kernel.estimate.loops.lagging_counters import without_lagging
from bfsim.kernel.estimate.loops.memory_lengths import count_memory_calls
from bfsim.kernel.estimate.memory.early_loads import with_early_loads
from bfsim.kernel.estimate.memory.invariant_loads import hoist_loads
from bfsim.kernel.estimate.memory.merged_stores import merge_stores
from bfsim.kernel.estimate.memory.predictive_commoning import with_predictive_commoning
from bfsim.kernel.estimate.memory.split_loads import split_loads
from bfsim.kernel.estimate.memory.sunk_stores import with_sunk_stores
from bfsim.kernel.estimate.redundancies.carried_operations import with_carried_operations
from bfsim.kernel.estimate.redundancies.carried_values import carry_over
from bfsim.kernel.estimate.redundancies.chosen_loads import with_chosen_loads
from bfsim.kernel.estimate.redundancies.hoisted_code import with_hoisted_code
from bfsim.kernel.estimate.redundancies.hoisted_loads import with_hoisted_loads
from bfsim.kernel.estimate.redundancies.partial_redundancies import without_partial_redundancies
from bfsim.kernel.estimate.redundancies.redundant_loads import without_redundant_loads
from bfsim.kernel.estimate.redundancies.repeated_loads import without_repeated_loads
from bfsim.kernel.estimate.redundancies.sinking import sink
from bfsim.kernel.estimate.switches.bit_tests import with_bit_tests
from bfsim.kernel.estimate.switches.jump_tables import with_jump_tables
from bfsim.kernel.ir.preheaders import with_preheaders
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.ir.text import Routine
from bfsim.kernel.ir.widths import WORD
from bfsim.kernel.ir.writing import with_names, write_module
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule

REWRITES: tuple[Callable[[Routine], Routine], ...] = (
    with_restored_values,
    with_same_truths,
    with_tests_of_next_values,
    with_shifted_tests,
    split_loads,
    with_wide_counts,
    with_operations_on_sides,
    with_shifted_products,
    with_shifted_bits,
    with_sides_apart,
    with_narrow_sides,
    with_reduced_strength,
    with_summed_indices,
    with_even_addresses,
    without_saturations,
    with_clamps,
    widen_extremes,
    without_lagging,
    factor_sums,
    with_subtractions,
    with_common_factors,
    split_tests,
    merge_stores,
    with_chosen_loads,
    without_partial_redundancies,
    with_hoisted_code,
    with_hoisted_loads,
    copy_headers,
    copy_breaks,
    with_preheaders,
    without_redundant_loads,
    carry_over,
    with_carried_operations,
    with_early_loads,
    sink,
    hoist_loads,
    with_final_values,
    with_stepped_values,
    with_predictive_commoning,
    with_bit_tests,
    with_narrow_sums,
    with_jump_tables,
)
"""In this order."""
SWITCHES = {
    without_lagging: Rule.LAGGING_COUNTERS,
    factor_sums: Rule.FACTORED_SUMS,
    with_common_factors: Rule.COMMON_FACTORS,
    split_tests: Rule.SPLIT_TESTS,
    split_loads: Rule.MERGED_LOADS,
    without_partial_redundancies: Rule.PARTIAL_REDUNDANCIES,
    with_hoisted_code: Rule.CODE_HOISTING,
    with_hoisted_loads: Rule.COMMON_LOADS,
    with_chosen_loads: Rule.CARRIED_LOADS,
    without_redundant_loads: Rule.CARRIED_LOADS,
    with_early_loads: Rule.SINKING,
    sink: Rule.SINKING,
    copy_headers: Rule.COPIED_HEADERS,
    copy_breaks: Rule.COPIED_BREAKS,
    with_final_values: Rule.FINAL_VALUES,
    with_predictive_commoning: Rule.PREDICTIVE_COMMONING,
    with_stepped_values: Rule.STEPPED_VALUES,
    with_reduced_strength: Rule.STRENGTH_REDUCTION,
    with_summed_indices: Rule.SUMMED_INDICES,
    with_even_addresses: Rule.EVEN_ADDRESSES,
    with_shifted_products: Rule.SHIFTED_PRODUCTS,
    with_operations_on_sides: Rule.OWN_OPERATIONS,
    with_clamps: Rule.EXTREMES,
    with_narrow_sides: Rule.NARROW_CHOICES,
    with_carried_operations: Rule.PARTIAL_REDUNDANCIES,
    with_bit_tests: Rule.BIT_TESTS,
    with_narrow_sums: Rule.EXTREMES,
    with_jump_tables: Rule.JUMP_TABLES,
}
"""Those that can be left out."""


def rewritten_early(text: str, profile: CompilerProfile) -> str:
    """Return the module `text`, in which variables are registers and nothing else was done yet, after what compilers do first."""
    text = _each(with_names(text), lambda routine: _rewritten_early(routine, profile))
    names = (f"i{WORD} @llvm.{sign}{name}.i{WORD}" for sign in "su" for name in ("min", "max"))
    missing = (f"declare {each}(i{WORD}, i{WORD})" for each in names if f"declare {each}" not in text)
    return "\n".join((text, *missing))


def _rewritten_early(routine: Routine, profile: CompilerProfile) -> Routine:
    routine = without_repeated_loads(routine)
    if profile.applies(Rule.EXTREMES):
        routine = with_nearer_bounds(routine)
    if profile.applies(Rule.BIT_TESTS):
        routine = with_range_tests(routine)
    if profile.applies(Rule.ADJACENT_NUMBERS):
        routine = with_adjacent_numbers(routine)
    if profile.applies(Rule.REMAINDERS):
        routine = with_remainders(routine)
    if profile.applies(Rule.NARROW_CHOICES):
        routine = with_narrow_tests(routine)
    if profile.applies(Rule.SUNK_STORES):
        routine = with_sunk_stores(routine)
    if profile.applies(Rule.EXTREMES):
        routine = with_extremes(routine, narrows=profile.applies(Rule.NARROW_CHOICES))
    return with_known_answers(routine)


def rewritten(text: str, profile: CompilerProfile) -> str:
    """Return the module `text` after all rewrites of each of its routines that `profile` applies."""
    return _each(with_names(text), lambda routine: _rewritten(routine, profile))


def _each(text: str, rewrite: Callable[[Routine], Routine]) -> str:
    return write_module(text, [rewrite(each) for each in read_module(text)])


def _rewritten(routine: Routine, profile: CompilerProfile) -> Routine:
    for rewrite in REWRITES:
        if rewrite not in SWITCHES or profile.applies(SWITCHES[rewrite]):
            routine = rewrite(routine)
    return routine


def rewritten_last(text: str, profile: CompilerProfile) -> str:
    """Return the module `text` as it is costed; no pass may follow.

    One would put numbers back in place of variables, and leave out what counts the bytes that a routine of the library fills or moves.
    """
    if profile.applies(Rule.KNOWN_VALUES):
        text = _each(text, with_known_values)
    return _each(text, partial(count_memory_calls, library=profile.library))
