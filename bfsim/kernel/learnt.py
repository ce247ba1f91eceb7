"""Rules of the lowering that were found by looking at what GCC made of certain kernels: [fitted].

All others follow from the instruction set or from GCC's own source, and name their source where they stand. The
accuracy benchmark costs each kernel once more without the rules that were learnt from it alone.
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
    LEAVING_SIDE = (
        "of two equally likely sides of a test in a loop, the one that may leave the loop is not in line"
    )
    CLEARED_BIT = "half of a number that is the index of half-words is the number with its last bit cleared"
    KNOWN_SIGN = "a value known to be positive is divided by a constant with the signed routine"


# [fitted] the kernels that each rule was learnt from
LEARNT_FROM: dict[Learnt, tuple[str, ...]] = {
    Learnt.LATE_EXTENSION: ("gauss3_row",),
    Learnt.RELOAD_REGISTER: ("match_lines",),
    Learnt.POINTER_COPIES: ("insertion_sort_u16", "shell_sort"),
    Learnt.COPIED_END: ("insertion_sort_u16", "shell_sort"),
    Learnt.SUNK_MASK: ("crc16_bits",),
    Learnt.NARROW_SUMS: ("flood_fill",),
    Learnt.RAW_BYTE: ("bilinear_row",),
    Learnt.FACTORS: ("alpha_blend", "variance_blocks"),
    Learnt.COMPARED: ("match_lines", "alpha_blend", "conv3x3"),
    Learnt.GUARDS: ("circle_vote", "cordic_atan"),
    Learnt.ACCUMULATORS: ("moments",),
    Learnt.DIFFERENCE: ("sad_search",),
    Learnt.COMMON_LOADS: ("cordic_atan",),
    Learnt.LEAVING_SIDE: ("grow_segments",),
    Learnt.CLEARED_BIT: ("lower_bound", "table_search", "quick_sort"),
    Learnt.KNOWN_SIGN: ("digits",),
}
