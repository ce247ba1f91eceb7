"""dsp32shift and dsp32shiftimm: shifts and rotations, by a register or by a number.

Letters: d the destination, t what is shifted, s the register with the count, n the count, positive to the left; h and l
the halves of d and t, a an accumulator. Counts beyond the width of a word, which no assembler makes, do what GNU's
tests have seen the hardware do.
"""

from __future__ import annotations

from collections.abc import Callable

from bfsim.blackfin.instructions.form import Beside, Form


def _by_register(does: str, bits: str, text: str) -> Form:
    return Form(does, f"1100 -110 000 {bits}", text, beside=Beside.DSP)


def _by_number(does: str, bits: str, text: str, least: int = -32, most: int = 31) -> Form:
    return Form(does, f"1100 -110 100 {bits}", text, beside=Beside.DSP, only=_within(least, most))


def _within(least: int, most: int) -> Callable[..., bool]:
    return lambda n, **_: least <= n <= most


HALVES = "{d:R}.{h:half} = {t:R}.{l:half}"

FORMS = (
    _by_register(
        "ashift_half", "00000 00hl ddd 000 sss ttt", "{d:R}.{h:half} = ASHIFT {t:R}.{l:half} BY {s:R}.L"
    ),
    _by_register(
        "ashift_half_s", "00000 01hl ddd 000 sss ttt", "{d:R}.{h:half} = ASHIFT {t:R}.{l:half} BY {s:R}.L (S)"
    ),
    _by_register(
        "lshift_half", "00000 10hl ddd 000 sss ttt", "{d:R}.{h:half} = LSHIFT {t:R}.{l:half} BY {s:R}.L"
    ),
    _by_register("ashift_pair", "00001 0000 ddd 000 sss ttt", "{d:R} = ASHIFT {t:R} BY {s:R}.L (V)"),
    _by_register("ashift_pair_s", "00001 0100 ddd 000 sss ttt", "{d:R} = ASHIFT {t:R} BY {s:R}.L (V, S)"),
    _by_register("lshift_pair", "00001 1000 ddd 000 sss ttt", "{d:R} = LSHIFT {t:R} BY {s:R}.L (V)"),
    _by_register("ashift_register", "00010 0000 ddd 000 sss ttt", "{d:R} = ASHIFT {t:R} BY {s:R}.L"),
    _by_register("ashift_register_s", "00010 0100 ddd 000 sss ttt", "{d:R} = ASHIFT {t:R} BY {s:R}.L (S)"),
    _by_register("lshift_register", "00010 1000 ddd 000 sss ttt", "{d:R} = LSHIFT {t:R} BY {s:R}.L"),
    _by_register("rotate_register", "00010 1100 ddd 000 sss ttt", "{d:R} = ROT {t:R} BY {s:R}.L"),
    _by_register("ashift_accumulator", "00011 000a --- 000 sss ---", "{a:A} = ASHIFT {a:A} BY {s:R}.L"),
    _by_register("lshift_accumulator", "00011 010a --- 000 sss ---", "{a:A} = LSHIFT {a:A} BY {s:R}.L"),
    _by_register("rotate_accumulator", "00011 100a --- 000 sss ---", "{a:A} = ROT {a:A} BY {s:R}.L"),
    _by_number("shift_half", "00000 00hl ddd nnnnnn ttt", f"{HALVES} >>> {{n:right}}"),
    _by_number("shift_half_s", "00000 01hl ddd nnnnnn ttt", f"{HALVES} << {{n:left}} (S)", 0),
    _by_number("shift_half_right_s", "00000 01hl ddd nnnnnn ttt", f"{HALVES} >>> {{n:right}} (S)", -32, -1),
    _by_number("shift_half_logical", "00000 10hl ddd nnnnnn ttt", f"{HALVES} << {{n:left}}", 0),
    _by_number("shift_half_logical", "00000 10hl ddd nnnnnn ttt", f"{HALVES} >> {{n:right}}", -32, -1),
    _by_number("shift_pair", "00001 0000 ddd nnnnnn ttt", "{d:R} = {t:R} >>> {n:right} (V)"),
    _by_number("shift_pair_s", "00001 0100 ddd nnnnnn ttt", "{d:R} = {t:R} << {n:left} (V, S)", 0),
    _by_number("shift_pair", "00001 0100 ddd nnnnnn ttt", "{d:R} = {t:R} >>> {n:right5} (V, S)", -32, -1),
    _by_number("shift_pair_logical", "00001 1000 ddd nnnnnn ttt", "{d:R} = {t:R} << {n:left} (V)", 0, 15),
    _by_number("shift_pair_logical", "00001 1000 ddd nnnnnn ttt", "{d:R} = {t:R} >> {n:right} (V)", -15, -1),
    _by_number("shift_register", "00010 0000 ddd nnnnnn ttt", "{d:R} = {t:R} >>> {n:right}", -31, 0),
    _by_number("shift_register_logical", "00010 0000 ddd nnnnnn ttt", "{d:R} = {t:R} >>> {n:right}", 1),
    _by_number("shift_register_s", "00010 0100 ddd nnnnnn ttt", "{d:R} = {t:R} << {n:left} (S)"),
    _by_number("shift_register_logical", "00010 1000 ddd nnnnnn ttt", "{d:R} = {t:R} << {n:left}", 0),
    _by_number("shift_register_logical", "00010 1000 ddd nnnnnn ttt", "{d:R} = {t:R} >> {n:right}", -31, -1),
    _by_number("rotate_register_by", "00010 1100 ddd nnnnnn ttt", "{d:R} = ROT {t:R} BY {n:imm6}"),
    _by_number("shift_accumulator", "00011 000a --- nnnnnn ---", "{a:A} = {a:A} >>> {n:right}", -32, -1),
    _by_number("shift_accumulator_logical", "00011 000a --- nnnnnn ---", "{a:A} = {a:A} << {n:left}", 0),
    _by_number("shift_accumulator_logical", "00011 010a --- nnnnnn ---", "{a:A} = {a:A} >> {n:right}"),
    _by_number("rotate_accumulator_by", "00011 100a --- nnnnnn ---", "{a:A} = ROT {a:A} BY {n:imm6}"),
)
