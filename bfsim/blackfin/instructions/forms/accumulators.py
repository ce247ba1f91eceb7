"""dsp32alu on the 40-bit accumulators: moves of them and of their parts, sums, magnitudes, negation and saturation.

Letters: a the accumulator that is written, b the one that is read; d e destinations, s a source, h the half of d; q saturates.
"""

from __future__ import annotations

from bfsim.blackfin.instructions.forms.dsp32alu import dsp32alu

FORMS = (
    dsp32alu("clear_accumulator", "0 01000 0a00 --- --- --- ---", "{a:A} = 0"),
    dsp32alu("clear_accumulators", "0 01000 1000 --- --- --- ---", "A1 = A0 = 0"),
    dsp32alu("saturate_accumulator", "0 01000 0a10 --- --- --- ---", "{a:A} = {a:A} (S)"),
    dsp32alu("saturate_accumulators", "0 01000 1010 --- --- --- ---", "A1 = A1 (S), A0 = A0 (S)"),
    dsp32alu("copy_accumulator", "0 01000 1100 --- --- --- ---", "A0 = A1", a="A0", b="A1"),
    dsp32alu("copy_accumulator", "0 01000 1110 --- --- --- ---", "A1 = A0", a="A1", b="A0"),
    dsp32alu("load_accumulator", "0 01001 a010 --- --- sss ---", "{a:A} = {s:R}"),
    dsp32alu("load_low", "0 01001 a000 --- --- sss ---", "{a:A}.L = {s:R}.L"),
    dsp32alu("load_high", "1 01001 a000 --- --- sss ---", "{a:A}.H = {s:R}.H"),
    dsp32alu("load_extension", "0 01001 a100 --- --- sss ---", "{a:A}.X = {s:R}.L"),
    dsp32alu("move_extension", "0 01010 0a00 ddd --- --- ---", "{d:R}.L = {a:A}.X"),
    dsp32alu("sum_halves", "0 01100 0100 ddd eee --- ---", "{e:R} = A1.L + A1.H, {d:R} = A0.L + A0.H"),
    dsp32alu("add_accumulators", "0 01011 1000 --- --- --- ---", "A0 += A1"),
    dsp32alu("add_accumulators_w32", "0 01011 1010 --- --- --- ---", "A0 += A1 (W32)"),
    dsp32alu("subtract_accumulators", "0 01011 1100 --- --- --- ---", "A0 -= A1"),
    dsp32alu("subtract_accumulators_w32", "0 01011 1110 --- --- --- ---", "A0 -= A1 (W32)"),
    dsp32alu("add_accumulators_to_register", "0 01011 0000 ddd --- --- ---", "{d:R} = (A0 += A1)"),
    dsp32alu("add_accumulators_to_half", "h 01011 0100 ddd --- --- ---", "{d:R}.{h:half} = (A0 += A1)"),
    dsp32alu(
        "add_subtract_accumulators",
        "0 10001 00q0 ddd eee --- ---",
        "{e:R} = A1 + A0, {d:R} = A1 - A0{q:saturation}",
        a="A1",
        b="A0",
    ),
    dsp32alu(
        "add_subtract_accumulators",
        "0 10001 01q0 ddd eee --- ---",
        "{e:R} = A0 + A1, {d:R} = A0 - A1{q:saturation}",
        a="A0",
        b="A1",
    ),
    dsp32alu("absolute_accumulator", "a 10000 0b00 --- --- --- ---", "{a:A} = ABS {b:A}"),
    dsp32alu("absolute_accumulators", "0 10000 1100 --- --- --- ---", "A1 = ABS A1, A0 = ABS A0"),
    dsp32alu("negate_accumulator", "a 01110 0b00 --- --- --- ---", "{a:A} = -{b:A}"),
    dsp32alu("negate_accumulators", "0 01110 1100 --- --- --- ---", "A1 = -A1, A0 = -A0"),
)
