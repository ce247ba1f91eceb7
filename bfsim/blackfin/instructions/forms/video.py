"""dsp32alu on bytes: the video instructions, on the register pairs R1:0 and R3:2.

Letters: d e destinations, s t pairs, q (R) which exchanges the registers of a pair, c (T) which truncates, h the place of the results.
"""

from __future__ import annotations

from bfsim.blackfin.instructions.forms.dsp32alu import dsp32alu

FORMS = (
    dsp32alu("disalgnexcpt", "0 10010 1100 --- --- --- ---", "DISALGNEXCPT"),
    dsp32alu(
        "byteop1p", "0 10100 00q0 ddd --- sss ttt", "{d:R} = BYTEOP1P ({s:pair}, {t:pair}){q:reverse}", up=1
    ),
    dsp32alu(
        "byteop1p",
        "0 10100 01q0 ddd --- sss ttt",
        "{d:R} = BYTEOP1P ({s:pair}, {t:pair}) (T{q:and_reverse})",
        up=0,
    ),
    dsp32alu(
        "byteop2p",
        "h 10110 0cq0 ddd --- sss ttt",
        "{d:R} = BYTEOP2P ({s:pair}, {t:pair}) ({c:rounding}{h:half}{q:and_reverse})",
    ),
    dsp32alu(
        "byteop3p",
        "h 10111 00q0 ddd --- sss ttt",
        "{d:R} = BYTEOP3P ({s:pair}, {t:pair}) ({h:end}{q:and_reverse})",
    ),
    dsp32alu(
        "byteop16p",
        "0 10101 00q0 ddd eee sss ttt",
        "({e:R}, {d:R}) = BYTEOP16P ({s:pair}, {t:pair}){q:reverse}",
    ),
    dsp32alu(
        "byteop16m",
        "0 10101 01q0 ddd eee sss ttt",
        "({e:R}, {d:R}) = BYTEOP16M ({s:pair}, {t:pair}){q:reverse}",
    ),
    dsp32alu("bytepack", "0 11000 0000 ddd --- sss ttt", "{d:R} = BYTEPACK ({s:R}, {t:R})"),
    dsp32alu("byteunpack", "0 11000 01q0 ddd eee sss ---", "({e:R}, {d:R}) = BYTEUNPACK {s:pair}{q:reverse}"),
    dsp32alu("saa", "0 10010 00q0 --- --- sss ttt", "SAA ({s:pair}, {t:pair}){q:reverse}"),
)
