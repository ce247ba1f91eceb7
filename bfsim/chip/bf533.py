"""The ADSP-BF533: one core of the BF561's kind, no L2, half as wide outside. `grep assumed` lists the guesses."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from bfsim.chip.bf561 import BF561
from bfsim.chip.interrupts import Bf533Interrupt
from bfsim.chip.memory_map import BF533_REGIONS

BF533 = replace(
    BF561,  # [assumed] what is not named here: the same core, the same blocks around it
    name="ADSP-BF533",
    cores=("A",),
    ppis=1,                             # Linux mach-bf533 irq.h
    max_vco_hz=Fraction(750_000_000),   # Linux CM-BF533_defconfig, MAX_VCO_HZ
    max_sclk_hz=Fraction(400_000_000, 3),  # the same, MAX_SCLK_HZ, which has 133333333
    regions=BF533_REGIONS,
    l2=None,                            # Linux mach-bf533 mem_map.h
    dma=replace(
        BF561.dma,
        controllers=1,                  # Linux mach-bf533/dma.c: 8 channels
        mdma_streams=2,                 # the same
        word_bytes=2,                   # [assumed] DAB, DCB and DEB are 16 bits wide
        imdma_word_cclk=0,
    ),
    interrupts=Bf533Interrupt,
)  # fmt: skip
