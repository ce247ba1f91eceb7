"""Rules of the estimate that can be left out, by name: what each says, whose behaviour it is, and what it was learnt from.

`python benchmarks/accuracy.py --ablate` prints what each is worth. Two kinds come from GCC's code of certain kernels:
[fitted] rules, found by looking at that code, and rules that follow from GCC's own source or from the instruction set,
but that only one of the measured kernels needs: without that kernel, nobody would have looked for them. The accuracy
benchmark also costs each kernel without the rules that it alone needs; `python benchmarks/accuracy.py --rules` finds
anew which kernels need each rule. Rules that cannot be left out name their source where they stand.
"""

from __future__ import annotations

from enum import StrEnum


class Rule(StrEnum):
    """A rule that a profile may leave out."""

    LATE_EXTENSION = (
        "a narrow load with a post-increment is extended on its own if others follow before its use"
    )
    RELOAD_REGISTER = "where values do not fit in registers, one register serves the reloads"
    POINTER_COPIES = "a loop with two exits that are not counted keeps a pointer before and after its step"
    SUNK_MASK = "masks of 8 or 16 bits that end both sides of a test are done once behind them"
    NARROW_SUMS = "a sum that is stored as narrow and used as wide is computed twice"
    FACTORS = "a byte that is a factor of a 16-bit product and used in another way is extended for each"
    COMPARED = "a constant that is compared with is loaded where it is, not before the loop"
    GUARDS = "a condition that does not change in a loop is kept in a register, and moved to CC and back"
    FACTORED_SUMS = "a sum with a constant is added up before it is multiplied"
    COMMON_FACTORS = (
        "products by one number are added up before they are multiplied, in sums of bytes and half-words"
    )
    ADJACENT_NUMBERS = "a choice between neighbouring numbers by a bit is computed from that"
    SMALL_NUMBERS = "a comparison with a small number, signed or not, is guessed like one with -1, 0 or 1"
    KNOWN_VALUES = "where ways meet, a number that a variable is known to be is that variable"
    DIFFERENCE = "the absolute value of a difference, written as an `if`, is a branch"
    COMMON_LOADS = "what every way from a test loads is loaded before it, if one of its sides does so"
    KNOWN_SIGN = "a value known to be positive is divided by a constant with the signed routine"
    DIVIDED_COUNTS = "a loop whose number of iterations takes a division to find is not counted"
    INCLUSIVE_LOOPS = "a loop up to and with its bound is not counted if it has another exit"
    FIXED_STARTS = (
        "a loop with several exits whose counters start at constants is counted, wide as its steps are"
    )
    SPLIT_LOOPS = "a loop that a `continue` splits is guessed as one, and counted by its first test"
    EVALUATED_LOOPS = "the number of iterations of a loop may be found by playing it through"
    THREADED_EXITS = "a block that sets the flag which ends its loop is outside of the loop"
    ELIMINATED_COUNTERS = "beside neighbours, a pointer stands for a counter that only some iterations want"
    CARRIED_LOADS = "a load that the choice of an index in a loop makes redundant goes along in a register"
    SINKING = "what only the rarer side of a test needs is computed there"
    MERGED_LOADS = "a load from an address that several ways choose is a load on each of them"
    NEIGHBOURS = "a test for one of two neighbouring numbers is one test"
    ADDED_FLAGS = "a flag that is added is added where it is set"
    REMAINDERS = "x - x / y * y is the remainder"
    KEPT_BITS = "a conversion that keeps every bit that may be set is none"
    STEPPED_COUNTERS = "a counter that only the next iteration wants is stepped in place, last"
    CONSTANT_MOVES = "constants that do not fit in the registers of a loop come from others, by a move"
    KEPT_RESULTS = "a result that is wanted behind the next call moves out of R0"
    OPPOSITE_FLAGS = "a flag that no comparison says is the opposite of one that one says"
    SINGLE_BITS = "a single bit is set, cleared or toggled by its number, without a mask"
    BIT_COUNTS = "a loop that clears the lowest bit until none is left is an instruction"
    COPIED_HEADERS = "a loop of two tests is rotated until both are at its end"
    PREPARED_DIFFERENCES = "a counter is its pointer less what is computed before the loop"
    COMPARED_COUNTERS = "a counter of a loop is guessed to be within what bounds it"
    LOOP_GUARDS = "a test that decides whether an inner loop is come to is guessed to fail"
    ROTATED_ONCE = "a loop that ends with its test is not rotated again"
    SPLIT_TESTS = "`and` and `or` are branches, each test its own"
    COPIED_BREAKS = (
        "a loop that ends with a `break` once it has added up enough is rotated until that test is at its end"
    )
    FREQUENT_COUNTERS = (
        "a counter whose value an iteration wants more than once is stepped, whatever pointer stands for it"
    )
    LAGGING_COUNTERS = (
        "what a loop carries to have its counter an iteration later is the counter less its step"
    )
    PARALLEL_COUNTS = "bits that are counted in parallel are counted by an instruction"
    SPILLED_RANGES = "what is reloaded is used least for the places at which it is in the way"
    FINAL_VALUES = "a counter that is wanted behind its loop is computed there, of how often that iterates"
    PARTIAL_REDUNDANCIES = (
        "an operation that changes nothing on one way to it is done on the others alone, with a branch"
    )
    CONDITIONAL_MOVES = "a choice is a branch if its register is tested or both its values are copied, and overwrites no number of a loop"
    BUNDLES = "an access shares a bundle with a 32-bit instruction that is issued in the same cycle"
    EXTREMES = "a minimum is found before what is done with it is moved to the ways on which its values come"
    SUNK_STORES = "stores to one place on all ways to a block are one store of a choice"
    NARROW_CHOICES = (
        "of a conditional expression that is stored as narrow, both sides are converted before one is chosen"
    )
    SKIPPED_ITERATIONS = "an iteration that a `continue` skips at one value of its counter is none: the counter is the next one"
    THREADED_HINTS = "a `continue` makes each way to it unlikely, also those that jumps of an inlined kernel were threaded to"
    PREDICTIVE_COMMONING = (
        "what an iteration loads that an earlier one has loaded or stored goes along in registers"
    )
    COUNTER_REGISTERS = (
        "the counter of a hardware loop takes a pointer register while the registers are allocated"
    )
    KEPT_ADDRESSES = "a pointer is copied where accesses come before the one with its post-increment, and loads are made behind it"
    STEPPED_BETWEEN = (
        "what is loaded is extended on its own if its pointer is kept before a step that comes between"
    )
    NARROW_TREES = "of an expression that is stored as narrow, the operands are narrow, and extended apart for other uses"
    SUM_CLASSES = (
        "words that are loaded and added to a sum that is only added to are in pointer registers, and moved"
    )
    BIT_TESTS = "tests of a value for several numbers that lead to one place are tests for a range, without a bit, or for a bit of a mask"
    JUMP_TABLES = "tests of a value for at least five numbers, one after the other, are a jump by a table"
    CONSTANT_TABLES = "such tests that only choose constants are a load from a table"
    STATE_MACHINES = "a way round a loop on which the number of such tests is known leads past them"
    DOWNWARD_POINTERS = "a pointer that walks down is stepped by an access, as one that walks up"
    COPIES_IN_FRONT = (
        "what a counted loop of several blocks copies on its way back is copied in front of its first block"
    )
    STRENGTH_REDUCTION = (
        "a product beside one of a number that is a few less is that one and a few of its factors"
    )
    SHIFTED_PRODUCTS = "a product that is shifted left is one product and a shift"
    OWN_OPERATIONS = "what each side of a test computes is computed there, not once behind them, of a choice"
    ARGUMENT_LOADS = (
        "an argument on the stack that is used once, outside of loops, is loaded where it is used"
    )
    STAYING_ARGUMENTS = "an argument on the stack that is seldom used stays there where a register would have to be saved for it"
    EXPANSION_ORDER = "what is used once is computed where it is used, the longer operand first"
    BYTE_ADDRESSES = "of an array of bytes that comes in a data register, addresses are added up there if they are all that uses it"
    STEPPED_BEFORE = (
        "a loop that ends with a test, with the next value of its counter computed before, is not rotated"
    )
    PRODUCT_STEPS = "the shifts and sums of a product are each in a bank that has them, and an addition does the last shift"
    NARROW_FACTORS = "a product is one of 16 bits if both factors are narrow in C: loaded, masked, or a number that fits the type of the other"
    ADDRESS_CLASSES = "an address of a byte is added where that costs the fewest moves, and an argument that only it takes waits in its data register"
    NARROW_BITS = "narrow values are masked and joined bit by bit before they are extended"
    EVEN_ADDRESSES = "half of a number as an index of words of 16 bits is the number without its lowest bit"
    SUMMED_INDICES = "an index that is a sum is added up before it becomes an address, unless elements are bytes and one access uses it"
    CODE_HOISTING = "what every way from a test computes is computed before it, if one of its sides does so"
    THREADED_CHOICES = "a way on which a number was chosen leads past later tests of it"
    KEPT_BOUNDS = "where an iteration leaves a number as it was, its bound is not tested again"
    FIRST_ITERATIONS = "what only the first iteration of a loop is for is tested before it, and a loop begins behind a test whose answer it knows"
    ENDS_OF_RANGES = "a test against the end of a value's range is one for a number"
    COMPUTED_STARTS = "a loop with several exits is counted where its first address is computed before it"
    CROSS_JUMPS = "what ends two blocks stands in the code once, if it is all of one"
    EITHER_BANK = "a value that may be in either bank gives way where one is full"
    INDEX_REGISTERS = "a pointer that only walks over half-words is in an index register where a pointer register would have to be saved for it"
    HALF_WORD_POINTERS = (
        "a pointer to half-words that a sum of its own steps is in the data register that it comes in"
    )
    SHIFTED_COUNTS = (
        "a number of iterations that is shifted takes a pointer register beside that of its bound"
    )
    STEPPED_VALUES = "a multiple or sum of a counter is a variable of its own, which the loop steps"
    ROW_POINTERS = "a loop around steps where the pointers of a loop in it start"
    SPILLED_SUMS = "a sum that has no data register is added to in an I register"
    FIELD_ADDRESSES = "a field of a record that is loaded and stored has an address of its own"
    POINTER_DIFFERENCES = (
        "what only some iterations want of a counter is a difference to a pointer, if that costs less"
    )


GCC: dict[Rule, str] = {
    Rule.COPIED_HEADERS: "should_duplicate_loop_header_p in tree-ssa-loop-ch.cc",
    Rule.PREPARED_DIFFERENCES: "get_computation_cost in tree-ssa-loop-ivopts.cc",
    Rule.COMPARED_COUNTERS: "predict_iv_comparison in predict.cc",
    Rule.LOOP_GUARDS: "PRED_LOOP_GUARD in predict.cc",
    Rule.ROTATED_ONCE: "do_while_loop_p in tree-ssa-loop-ch.cc",
    Rule.COPIED_BREAKS: "should_duplicate_loop_header_p in tree-ssa-loop-ch.cc",
    Rule.FREQUENT_COUNTERS: "get_scaled_computation_cost_at in tree-ssa-loop-ivopts.cc",
    Rule.LAGGING_COUNTERS: '"Too few iterations" in loop-doloop.cc, of a distance that is known',
    Rule.PARALLEL_COUNTS: '"branchless implementations of popcount" in match.pd',
    Rule.SPILLED_RANGES: "allocno_spill_priority in ira-color.cc",
    Rule.FINAL_VALUES: "final_value_replacement_loop in tree-scalar-evolution.cc",
    Rule.PARTIAL_REDUNDANCIES: "do_pre_regular_insertion in tree-ssa-pre.cc",
    Rule.CONDITIONAL_MOVES: "cond_move_process_if_block in ifcvt.cc",
    Rule.BUNDLES: "bfin_gen_bundles in bfin.cc",
    Rule.EXTREMES: "minmax_replacement in tree-ssa-phiopt.cc",
    Rule.SUNK_STORES: "sink_common_stores_to_bb in tree-ssa-sink.cc",
    Rule.NARROW_CHOICES: "factor_out_conditional_conversion in tree-ssa-phiopt.cc",
    Rule.SKIPPED_ITERATIONS: "tree-ssa-threadbackward.cc",
    Rule.THREADED_HINTS: "predict_paths_leading_to in predict.cc",
    Rule.PREDICTIVE_COMMONING: "tree-predcom.cc, which the vectoriser of -O2 brings along",
    Rule.COUNTER_REGISTERS: "loop_end in bfin.md",
    Rule.KEPT_ADDRESSES: "add_autoinc_candidates in tree-ssa-loop-ivopts.cc, tree-ssa-ter.cc",
    Rule.STEPPED_BETWEEN: "can_combine_p in combine.cc",
    Rule.NARROW_TREES: "convert_to_integer_1 in convert.cc",
    Rule.SUM_CLASSES: "find_costs_and_classes in ira-costs.cc",
    Rule.DOWNWARD_POINTERS: "add_autoinc_candidates in tree-ssa-loop-ivopts.cc",
    Rule.COPIES_IN_FRONT: "reorder_loops in hw-doloop.cc",
    Rule.BIT_TESTS: "optimize_range_tests in tree-ssa-reassoc.cc",
    Rule.JUMP_TABLES: "gimple-if-to-switch.cc",
    Rule.CONSTANT_TABLES: "switch_conversion in tree-switch-conversion.cc",
    Rule.STATE_MACHINES: "tree-ssa-threadbackward.cc",
    Rule.COMMON_LOADS: "do_hoist_insertion in tree-ssa-pre.cc",
    Rule.CODE_HOISTING: "do_hoist_insertion in tree-ssa-pre.cc",
    Rule.THREADED_CHOICES: "tree-ssa-threadbackward.cc",
    Rule.KEPT_BOUNDS: "tree-ssa-threadbackward.cc",
    Rule.ENDS_OF_RANGES: "simplify_using_ranges in vr-values.cc",
    Rule.COMPUTED_STARTS: "simplify_using_initial_values in loop-iv.cc",
    Rule.FIRST_ITERATIONS: "profitable_path_p in tree-ssa-threadbackward.cc",
    Rule.EITHER_BANK: "find_costs_and_classes in ira-costs.cc",
    Rule.INDEX_REGISTERS: "assign_hard_reg in ira-color.cc",
    Rule.HALF_WORD_POINTERS: "find_costs_and_classes in ira-costs.cc",
    Rule.SHIFTED_COUNTS: "find_reg in reload1.cc",
    Rule.STEPPED_VALUES: "determine_iv_cost in tree-ssa-loop-ivopts.cc",
    Rule.ROW_POINTERS: "find_interesting_uses in tree-ssa-loop-ivopts.cc",
    Rule.SPILLED_SUMS: "addsi3 in bfin.md",
    Rule.FIELD_ADDRESSES: "try_combine in combine.cc",
    Rule.POINTER_DIFFERENCES: "determine_group_iv_cost_generic in tree-ssa-loop-ivopts.cc",
    Rule.CROSS_JUMPS: "try_crossjump_to_edge in cfgcleanup.cc",
    Rule.STRENGTH_REDUCTION: "gimple-ssa-strength-reduction.cc",
    Rule.SPLIT_TESTS: "LOGICAL_OP_NON_SHORT_CIRCUIT in fold-const.cc",
    Rule.KNOWN_SIGN: "expand_divmod in expmed.cc",
    Rule.COMMON_FACTORS: "undistribute_ops_list in tree-ssa-reassoc.cc",
    Rule.ADJACENT_NUMBERS: "two_value_replacement in tree-ssa-phiopt.cc",
    Rule.SMALL_NUMBERS: "tree_predict_by_opcode in predict.cc",
    Rule.KNOWN_VALUES: "tree-ssa-uncprop.cc",
    Rule.DIVIDED_COUNTS: '"Costs of niter computation too high" in loop-doloop.cc',
    Rule.INCLUSIVE_LOOPS: '"possible infinite iteration case" in loop-doloop.cc',
    Rule.FIXED_STARTS: '"possible infinite iteration case" in loop-doloop.cc',
    Rule.EVALUATED_LOOPS: "loop_niter_by_eval in tree-ssa-loop-niter.cc",
    Rule.THREADED_EXITS: "tree-ssa-threadbackward.cc",
    Rule.ELIMINATED_COUNTERS: "may_eliminate_iv in tree-ssa-loop-ivopts.cc",
    Rule.SINKING: "tree-ssa-sink.cc",
    Rule.NEIGHBOURS: "fold_range_test in fold-const.cc",
    Rule.ARGUMENT_LOADS: "combine_and_move_insns in ira.cc",
    Rule.STAYING_ARGUMENTS: "assign_hard_reg in ira-color.cc",
    Rule.EXPANSION_ORDER: "tree-ssa-ter.cc; reorder_operands in cfgexpand.cc",
    Rule.BYTE_ADDRESSES: "find_costs_and_classes in ira-costs.cc",
    Rule.STEPPED_BEFORE: "do_while_loop_p in tree-ssa-loop-ch.cc",
    Rule.PRODUCT_STEPS: "addsi3 and its like in bfin.md, try_combine in combine.cc",
    Rule.NARROW_FACTORS: "is_widening_mult_p in tree-ssa-math-opts.cc",
    Rule.ADDRESS_CLASSES: "find_costs_and_classes in ira-costs.cc",
    Rule.NARROW_BITS: '"(bitop (convert @0) (convert? @1))" in match.pd',
    Rule.OWN_OPERATIONS: "factor_out_conditional_conversion in tree-ssa-phiopt.cc, which takes nothing else",
    Rule.OPPOSITE_FLAGS: "cstoresi4 in bfin.md",
    Rule.EVEN_ADDRESSES: "combine.cc, by BITCLR in bfin.md",
    Rule.SINGLE_BITS: "BITSET, BITCLR and BITTGL in bfin.md",
}
"""Where GCC 12 does so; the others are fitted to its code."""

# The kernels that each rule was learnt from; if only one kernel needs a rule, that one.
LEARNT_FROM: dict[Rule, tuple[str, ...]] = {
    Rule.LATE_EXTENSION: ("gauss3_row",),
    Rule.RELOAD_REGISTER: ("match_lines",),
    Rule.POINTER_COPIES: ("insertion_sort_u16", "shell_sort"),
    Rule.SUNK_MASK: ("crc16_bits",),
    Rule.NARROW_SUMS: ("counting_sort", "fill_xy", "flood_fill"),
    Rule.FACTORS: ("alpha_blend", "variance_blocks"),
    Rule.COMPARED: ("match_lines", "alpha_blend", "conv3x3"),
    Rule.GUARDS: ("circle_vote", "cordic_atan"),
    Rule.FACTORED_SUMS: ("split_uyvy", "yuv_to_rgb"),
    Rule.COMMON_FACTORS: (),  # from kernels that are not measured here: tests/kernel/estimate/arithmetic/test_common_factors.py
    Rule.ADJACENT_NUMBERS: (),  # tests/kernel/estimate/choices/test_adjacent_numbers.py
    Rule.SMALL_NUMBERS: (),  # tests/kernel/estimate/conditions/test_small_numbers.py
    Rule.KNOWN_VALUES: (),  # from kernels that are not measured here: tests/kernel/estimate/choices/test_known_values.py
    Rule.DIFFERENCE: ("sad_search",),
    Rule.COMMON_LOADS: ("cordic_atan",),
    Rule.KNOWN_SIGN: ("digits",),
    Rule.DIVIDED_COUNTS: ("base64_encode",),
    Rule.INCLUSIVE_LOOPS: ("find_words",),
    Rule.FIXED_STARTS: ("grow_segments",),
    Rule.SPLIT_LOOPS: ("fill_stack",),
    Rule.EVALUATED_LOOPS: ("gray_decode",),
    Rule.THREADED_EXITS: ("grow_segments",),
    Rule.ELIMINATED_COUNTERS: ("cocktail_sort",),
    Rule.CARRIED_LOADS: ("selection_sort",),
    Rule.SINKING: ("fill_xy",),
    Rule.MERGED_LOADS: ("nms_row",),
    Rule.NEIGHBOURS: ("contrast_lut",),
    Rule.ADDED_FLAGS: ("count_words",),
    Rule.REMAINDERS: ("count_islands",),
    Rule.KEPT_BITS: ("crc16_table",),
    Rule.STEPPED_COUNTERS: ("percentiles",),
    Rule.CONSTANT_MOVES: ("hamming_pairs",),
    Rule.KEPT_RESULTS: ("morton",),
    Rule.EVEN_ADDRESSES: (),  # tests/kernel/estimate/loops/test_searches_by_halves.py
    Rule.OPPOSITE_FLAGS: (),  # from kernels that are not measured here: tests/kernel/estimate/choices/test_flags.py
    Rule.SINGLE_BITS: ("heap_sort",),
    Rule.BIT_COUNTS: ("popcount_words",),
    Rule.COPIED_HEADERS: ("run_tasks", "mu_law_block"),
    Rule.PREPARED_DIFFERENCES: ("centre_of_mass", "moved_boxes"),
    Rule.COMPARED_COUNTERS: ("label_regions", "largest_first"),
    Rule.LOOP_GUARDS: ("join_parts", "pack_runs"),
    Rule.ROTATED_ONCE: ("segment_row",),
    Rule.SPLIT_TESTS: ("ray_length", "unpack_runs", "lzss_expand"),
    Rule.COPIED_BREAKS: ("match_features",),
    Rule.FREQUENT_COUNTERS: (),  # tests/kernel/estimate/loops/test_gcc_shapes.py
    Rule.LAGGING_COUNTERS: ("border_strength",),
    Rule.PARALLEL_COUNTS: ("nearest_words",),
    Rule.SPILLED_RANGES: ("thin_once", "keep_ridges"),
    Rule.FINAL_VALUES: ("two_sums",),
    Rule.PARTIAL_REDUNDANCIES: (),  # from kernels that are not measured here: tests/kernel/estimate/redundancies/test_partial_redundancies.py
    Rule.CONDITIONAL_MOVES: ("ring_put", "nearest_words"),
    Rule.BUNDLES: ("dilate_grey_row", "crc16_table"),
    Rule.EXTREMES: (),  # from kernels that are not measured here: tests/kernel/estimate/choices/test_extremes.py
    Rule.SUNK_STORES: (),
    Rule.NARROW_CHOICES: (),
    Rule.SKIPPED_ITERATIONS: (),  # from kernels that are not measured here: tests/kernel/estimate/jump_threading/test_threaded_jumps.py
    Rule.THREADED_HINTS: (),
    Rule.PREDICTIVE_COMMONING: (),  # from kernels that are not measured here: tests/kernel/estimate/memory/test_predictive_commoning.py
    Rule.COUNTER_REGISTERS: (),
    Rule.KEPT_ADDRESSES: (),  # from kernels that are not measured here: tests/kernel/estimate/induction_variables/test_kept_addresses.py
    Rule.STEPPED_BETWEEN: (),
    Rule.NARROW_TREES: (),
    Rule.SUM_CLASSES: (),  # from kernels that are not measured here: tests/kernel/estimate/registers/test_register_classes.py
    Rule.DOWNWARD_POINTERS: ("keep_connected", "chamfer"),
    Rule.COPIES_IN_FRONT: (),  # from kernels that are not measured here: tests/kernel/estimate/memory/test_rows_of_pictures.py
    Rule.STRENGTH_REDUCTION: (),
    Rule.SUMMED_INDICES: (),
    Rule.SHIFTED_PRODUCTS: (),  # from kernels that are not measured here: tests/kernel/estimate/arithmetic/test_rows_of_numbers.py
    Rule.OWN_OPERATIONS: (),
    Rule.ARGUMENT_LOADS: (),
    Rule.STAYING_ARGUMENTS: (),  # from kernels that are not measured here: tests/kernel/estimate/registers/test_saved_registers.py
    Rule.EXPANSION_ORDER: (),
    Rule.BYTE_ADDRESSES: (),
    Rule.STEPPED_BEFORE: (),
    Rule.PRODUCT_STEPS: (),
    Rule.NARROW_FACTORS: (),
    Rule.ADDRESS_CLASSES: (),
    Rule.NARROW_BITS: (),
    Rule.CODE_HOISTING: (),  # from kernels that are not measured here: tests/kernel/estimate/conditions/test_code_that_decides.py
    Rule.THREADED_CHOICES: (),
    Rule.KEPT_BOUNDS: (),  # from kernels that are not measured here: tests/kernel/estimate/jump_threading/test_kept_bounds.py
    Rule.ENDS_OF_RANGES: (),  # from kernels that are not measured here: tests/kernel/estimate/ranges/test_rings.py
    Rule.COMPUTED_STARTS: (),  # from kernels that are not measured here: tests/kernel/estimate/loops/test_computed_starts.py
    Rule.FIRST_ITERATIONS: (),  # from kernels that are not measured here: tests/kernel/estimate/jump_threading/test_first_iterations.py
    Rule.CROSS_JUMPS: (),  # tests/kernel/estimate/loops/test_ends_of_loops.py
    Rule.EITHER_BANK: (),  # from kernels that are not measured here: tests/kernel/estimate/registers/test_either_bank.py
    Rule.INDEX_REGISTERS: (),  # from kernels that are not measured here: tests/kernel/estimate/registers/test_index_registers.py
    Rule.HALF_WORD_POINTERS: (),  # from kernels that are not measured here: tests/kernel/estimate/registers/test_half_word_pointers.py
    Rule.SHIFTED_COUNTS: (),  # from kernels that are not measured here: tests/kernel/estimate/registers/test_iteration_counts.py
    Rule.STEPPED_VALUES: (),  # from kernels that are not measured here: tests/kernel/estimate/induction_variables/test_stepped_values.py
    Rule.ROW_POINTERS: (),
    Rule.SPILLED_SUMS: (),
    Rule.FIELD_ADDRESSES: (),  # from kernels that are not measured here: tests/kernel/estimate/induction_variables/test_field_addresses.py
    Rule.POINTER_DIFFERENCES: (),  # from kernels that are not measured here: tests/kernel/estimate/induction_variables/test_pointer_differences.py
    Rule.BIT_TESTS: (),
    Rule.CONSTANT_TABLES: (),
    Rule.STATE_MACHINES: (),
    Rule.JUMP_TABLES: (),  # from kernels that are not measured here: tests/kernel/estimate/switches/test_switches.py
}
