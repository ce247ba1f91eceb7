"""dsp32alu on data registers: sums and differences, also of halves, rounding, minima and maxima, magnitudes, signs, the search.

Letters: d e destinations, s t sources, h k l halves of d s t; q saturates; m saturation and exchange of halves.
"""

from __future__ import annotations

from bfsim.blackfin.instructions.forms.dsp32alu import dsp32alu

FORMS = (
    # Sums and differences. GNU objdump prints the plain ones with (NS), since without it they are 16-bit instructions.
    dsp32alu("sum_of_registers", "0 00100 00q0 ddd --- sss ttt", "{d:R} = {s:R} + {t:R}{q:saturation}"),
    dsp32alu(
        "difference_of_registers", "0 00100 01q0 ddd --- sss ttt", "{d:R} = {s:R} - {t:R}{q:saturation}"
    ),
    dsp32alu(
        "add_subtract",
        "0 00100 10q0 ddd eee sss ttt",
        "{e:R} = {s:R} + {t:R}, {d:R} = {s:R} - {t:R}{q:saturation}",
    ),
    dsp32alu(
        "add_half",
        "h 00010 klq0 ddd --- sss ttt",
        "{d:R}.{h:half} = {s:R}.{k:half} + {t:R}.{l:half}{q:saturation}",
    ),
    dsp32alu(
        "subtract_half",
        "h 00011 klq0 ddd --- sss ttt",
        "{d:R}.{h:half} = {s:R}.{k:half} - {t:R}.{l:half}{q:saturation}",
    ),
    # On both halves: the upper operation and the lower one.
    dsp32alu("vector", "0 00000 abmm ddd --- sss ttt", "{d:R} = {s:R} {a:sign}|{b:sign} {t:R}{m:crossing}"),
    *(
        dsp32alu(
            "quad",
            f"{low} 00001 {bits}mm ddd eee sss ttt",
            f"{text}{{m:crossing{scale}}}",
            low=low,
            scale=scale,
        )
        for low, text in enumerate(
            (
                "{e:R} = {s:R} +|+ {t:R}, {d:R} = {s:R} -|- {t:R}",
                "{e:R} = {s:R} +|- {t:R}, {d:R} = {s:R} -|+ {t:R}",
            )
        )
        for bits, scale in (("00", ""), ("10", "ASR"), ("11", "ASL"))
    ),
    # Rounding to a half.
    dsp32alu("round12", "h 00101 0a00 ddd --- sss ttt", "{d:R}.{h:half} = {s:R} {a:sign} {t:R} (RND12)"),
    dsp32alu("round20", "h 00101 1a01 ddd --- sss ttt", "{d:R}.{h:half} = {s:R} {a:sign} {t:R} (RND20)"),
    dsp32alu("round_half", "h 01100 1100 ddd --- sss ---", "{d:R}.{h:half} = {s:R} (RND)"),
    # Minima, maxima, magnitudes, signs.
    dsp32alu("maximum", "0 00111 0000 ddd --- sss ttt", "{d:R} = MAX ({s:R}, {t:R})"),
    dsp32alu("minimum", "0 00111 0100 ddd --- sss ttt", "{d:R} = MIN ({s:R}, {t:R})"),
    dsp32alu("absolute", "0 00111 1000 ddd --- sss ---", "{d:R} = ABS {s:R}"),
    dsp32alu("negate_register", "0 00111 11q0 ddd --- sss ---", "{d:R} = -{s:R}{q:saturation}"),
    dsp32alu("maximum_pair", "0 00110 0000 ddd --- sss ttt", "{d:R} = MAX ({s:R}, {t:R}) (V)"),
    dsp32alu("minimum_pair", "0 00110 0100 ddd --- sss ttt", "{d:R} = MIN ({s:R}, {t:R}) (V)"),
    dsp32alu("absolute_pair", "0 00110 1000 ddd --- sss ---", "{d:R} = ABS {s:R} (V)"),
    dsp32alu("negate_pair", "0 01111 1100 ddd --- sss ---", "{d:R} = -{s:R} (V)"),
    dsp32alu(
        "sign",
        "0 01100 0000 ddd --- sss ttt",
        "{d:R}.H = {d:R}.L = SIGN ({s:R}.H) * {t:R}.H + SIGN ({s:R}.L) * {t:R}.L",
    ),
    dsp32alu("search", "0 01101 mm00 ddd eee sss ---", "({e:R}, {d:R}) = SEARCH {s:R} ({m:comparison})"),
)
