"""Rules of the lowering that were put in because of what GCC made of certain kernels.

Two kinds: [fitted] ones, found by looking at GCC's code, and those that follow from GCC's own source or from the
instruction set but that a single one of the measured kernels needs: without that kernel, nobody would have looked for them.
All other rules name their source where they stand. The accuracy benchmark costs each kernel once more without the rules
that it alone needs: `python benchmarks/accuracy.py --rules` finds again which kernels need each.
"""

from __future__ import annotations

from enum import StrEnum


class Learnt(StrEnum):
    """A fitted rule."""

    LATE_EXTENSION = (
        "a narrow load with a post-increment is extended on its own if others follow before its use"
    )
    RELOAD_REGISTER = "where values do not fit in registers, one register serves the reloads"
    POINTER_COPIES = "a loop with two exits that are not counted keeps a pointer before and after its step"
    COPIED_END = "the end of a loop is copied behind each exit of the loop inside it"
    SUNK_MASK = "16-bit masks that end both sides of a test are done once behind them"
    NARROW_SUMS = "a sum that is stored as narrow and used as wide is computed twice"
    RAW_BYTE = "the low byte of a half-word is extended from the half-word as it was loaded"
    FACTORS = "a byte that is a factor of a 16-bit product and used in another way is extended for each"
    COMPARED = "a constant that is compared with is loaded where it is, not before the loop"
    GUARDS = "a condition that does not change in a loop is kept in a register, and moved to CC and back"
    ACCUMULATORS = "what a loop only adds to may live in another bank, for one move"
    DIFFERENCE = "the absolute value of a difference, written as an `if`, is a branch"
    COMMON_LOADS = "what both sides of a test load first is loaded before it"
    CLEARED_BIT = "half of a number that is the index of half-words is the number with its last bit cleared"
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
    HANDED_ON = "a minimum is one, too, where another way leads to what only hands its result on"
    MERGED_LOADS = "a load from an address that several ways choose is a load on each of them"
    NEIGHBOURS = "a test for one of two neighbouring numbers is one test"
    ADDED_FLAGS = "a flag that is added is added where it is set"
    REMAINDERS = "x - x / y * y is the remainder"
    KEPT_BITS = "a conversion that keeps every bit that may be set is none"
    STEPPED_COUNTERS = "a counter that only the next iteration wants is stepped in place, last"
    CONSTANT_MOVES = "constants that do not fit in the registers of a loop come from others, by a move"
    KEPT_RESULTS = "a result that is wanted behind the next call moves out of R0"
    SINGLE_BITS = "a single bit is set, cleared or toggled by its number, without a mask"
    BIT_COUNTS = "a loop that clears the lowest bit until none is left is an instruction"


# The kernels that each rule was learnt from; of a rule that one kernel alone needs, that one.
LEARNT_FROM: dict[Learnt, tuple[str, ...]] = {
    Learnt.LATE_EXTENSION: ("gauss3_row",),
    Learnt.RELOAD_REGISTER: ("match_lines",),
    Learnt.POINTER_COPIES: ("insertion_sort_u16", "shell_sort"),
    Learnt.COPIED_END: ("shell_sort",),
    Learnt.SUNK_MASK: ("crc16_bits",),
    Learnt.NARROW_SUMS: ("counting_sort", "fill_xy", "flood_fill"),
    Learnt.RAW_BYTE: ("bilinear_row",),
    Learnt.FACTORS: ("alpha_blend", "variance_blocks"),
    Learnt.COMPARED: ("match_lines", "alpha_blend", "conv3x3"),
    Learnt.GUARDS: ("circle_vote", "cordic_atan"),
    Learnt.ACCUMULATORS: ("moments",),
    Learnt.DIFFERENCE: ("sad_search",),
    Learnt.COMMON_LOADS: ("cordic_atan",),
    Learnt.CLEARED_BIT: ("lower_bound", "table_search", "quick_sort"),
    Learnt.KNOWN_SIGN: ("digits",),
    Learnt.DIVIDED_COUNTS: ("base64_encode",),
    Learnt.INCLUSIVE_LOOPS: ("find_words",),
    Learnt.FIXED_STARTS: ("grow_segments",),
    Learnt.SPLIT_LOOPS: ("fill_stack",),
    Learnt.EVALUATED_LOOPS: ("gray_decode",),
    Learnt.THREADED_EXITS: ("grow_segments",),
    Learnt.ELIMINATED_COUNTERS: ("cocktail_sort",),
    Learnt.CARRIED_LOADS: ("selection_sort",),
    Learnt.SINKING: ("fill_xy",),
    Learnt.HANDED_ON: ("fir_decimate",),
    Learnt.MERGED_LOADS: ("nms_row",),
    Learnt.NEIGHBOURS: ("contrast_lut",),
    Learnt.ADDED_FLAGS: ("count_words",),
    Learnt.REMAINDERS: ("count_islands",),
    Learnt.KEPT_BITS: ("crc16_table",),
    Learnt.STEPPED_COUNTERS: ("percentiles",),
    Learnt.CONSTANT_MOVES: ("hamming_pairs",),
    Learnt.KEPT_RESULTS: ("morton",),
    Learnt.SINGLE_BITS: ("heap_sort",),
    Learnt.BIT_COUNTS: ("popcount_words",),
}
