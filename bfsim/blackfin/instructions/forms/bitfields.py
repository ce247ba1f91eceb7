"""dsp32shift on bits: fields, halves and bytes put together, bits counted, multiplexed and folded.

Letters: d the destination, s t sources, h k l halves, a an accumulator, n how far bytes are shifted, less 1.
"""

from __future__ import annotations

from bfsim.blackfin.instructions.form import Beside, Form


def _shifter(does: str, bits: str, text: str, **given: int | str) -> Form:
    return Form(does, f"1100 -110 000 {bits}", text, given, Beside.DSP)


def _bitmux(does: str, bits: str, text: str) -> Form:
    return Form(does, f"1100 -110 000 {bits}", text, beside=Beside.DSP, only=lambda s, t: s != t)


FORMS = (
    _shifter("pack", "00100 kl00 ddd 000 sss ttt", "{d:R} = PACK ({t:R}.{k:half}, {s:R}.{l:half})"),
    _shifter("signbits_register", "00101 0000 ddd 000 --- ttt", "{d:R}.L = SIGNBITS {t:R}"),
    _shifter("signbits_half", "00101 0100 ddd 000 --- ttt", "{d:R}.L = SIGNBITS {t:R}.L", l=0),
    _shifter("signbits_half", "00101 1000 ddd 000 --- ttt", "{d:R}.L = SIGNBITS {t:R}.H", l=1),
    _shifter("signbits_accumulator", "00110 0a00 ddd 000 --- ---", "{d:R}.L = SIGNBITS {a:A}"),
    _shifter("ones", "00110 1100 ddd 000 --- ttt", "{d:R}.L = ONES {t:R}"),
    _shifter("expadj_register", "00111 0000 ddd 000 sss ttt", "{d:R}.L = EXPADJ ({t:R}, {s:R}.L)"),
    _shifter("expadj_pair", "00111 0100 ddd 000 sss ttt", "{d:R}.L = EXPADJ ({t:R}, {s:R}.L) (V)"),
    _shifter("expadj_half", "00111 1l00 ddd 000 sss ttt", "{d:R}.L = EXPADJ ({t:R}.{l:half}, {s:R}.L)"),
    _bitmux("bitmux_right", "01000 0000 --- 000 sss ttt", "BITMUX ({s:R}, {t:R}, A0) (ASR)"),
    _bitmux("bitmux_left", "01000 0100 --- 000 sss ttt", "BITMUX ({s:R}, {t:R}, A0) (ASL)"),
    _shifter("vit_max_left", "01001 0000 ddd 000 --- ttt", "{d:R}.L = VIT_MAX ({t:R}) (ASL)"),
    _shifter("vit_max_right", "01001 0100 ddd 000 --- ttt", "{d:R}.L = VIT_MAX ({t:R}) (ASR)"),
    _shifter("vit_max_pair_left", "01001 1000 ddd 000 sss ttt", "{d:R} = VIT_MAX ({t:R}, {s:R}) (ASL)"),
    _shifter("vit_max_pair_right", "01001 1100 ddd 000 sss ttt", "{d:R} = VIT_MAX ({t:R}, {s:R}) (ASR)"),
    _shifter("extract_z", "01010 0000 ddd 000 sss ttt", "{d:R} = EXTRACT ({t:R}, {s:R}.L) (Z)"),
    _shifter("extract_x", "01010 0100 ddd 000 sss ttt", "{d:R} = EXTRACT ({t:R}, {s:R}.L) (X)"),
    _shifter("deposit", "01010 1000 ddd 000 sss ttt", "{d:R} = DEPOSIT ({t:R}, {s:R})"),
    _shifter("deposit_x", "01010 1100 ddd 000 sss ttt", "{d:R} = DEPOSIT ({t:R}, {s:R}) (X)"),
    _shifter("bxorshift_register", "01011 0000 ddd 000 sss ---", "{d:R}.L = CC = BXORSHIFT (A0, {s:R})"),
    _shifter("bxor_register", "01011 0100 ddd 000 sss ---", "{d:R}.L = CC = BXOR (A0, {s:R})"),
    _shifter("bxorshift", "01100 0000 --- 000 --- ---", "A0 = BXORSHIFT (A0, A1, CC)"),
    _shifter("bxor", "01100 0100 ddd 000 --- ---", "{d:R}.L = CC = BXOR (A0, A1, CC)"),
    _shifter("align", "01101 0000 ddd 000 sss ttt", "{d:R} = ALIGN8 ({t:R}, {s:R})", distance=8),
    _shifter("align", "01101 0100 ddd 000 sss ttt", "{d:R} = ALIGN16 ({t:R}, {s:R})", distance=16),
    _shifter("align", "01101 1000 ddd 000 sss ttt", "{d:R} = ALIGN24 ({t:R}, {s:R})", distance=24),
)
