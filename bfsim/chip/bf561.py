"""The ADSP-BF561: ratings and timing. `grep assumed` lists every number without a document behind it."""

from __future__ import annotations

from fractions import Fraction

from bfsim.chip.block_spec import CacheSpec, DmaSpec, EventSpec, ExternalSpec, L1Spec, L2Spec
from bfsim.chip.interrupts import Bf561Interrupt
from bfsim.chip.memory_map import BF561_REGIONS, CACHE_NBYTES, KIB
from bfsim.chip.spec import ChipSpec

BF561 = ChipSpec(
    name="ADSP-BF561",
    cores=("A", "B"),
    ppis=2,                             # Linux mach-bf561 irq.h
    max_vco_hz=Fraction(600_000_000),   # Linux arch/blackfin/Kconfig, MAX_VCO_HZ
    max_sclk_hz=Fraction(400_000_000, 3),  # the same, MAX_SCLK_HZ, which has 133333333
    regions=BF561_REGIONS,
    l1=L1Spec(
        subbank_bytes=4 * KIB,          # bfin.sakura.ne.jp, l1_data_mem: a 16 KB block is four single-ported sub-banks
        conflict_cclk=1,                # the same, dual_access: two accesses to one sub-bank take turns
    ),
    cache=CacheSpec(
        line_bytes=32,                  # Programming Reference p.243
        data_ways=2,                    # bfin.sakura.ne.jp; 16 KB of bank A, or of A and B
        data_bytes_per_bank=CACHE_NBYTES,
        code_ways=4,                    # Programming Reference p.243: 4 ways, LRU
        code_bytes=CACHE_NBYTES,
        invalidate_cclk=2,              # [assumed] FLUSHINV [P++] in a hardware loop, and its tag access
    ),
    l2=L2Spec(
        read_cclk=9,                    # [assumed] first 64 bits of an access, range 7..11; writes are posted
        next_cclk=2,                    # [assumed] each further 64 bits, range 1..2
        port_bytes=8,                   # Programming Reference p.271: a 64-bit port for the cores
    ),
    external=ExternalSpec(
        core_sync_sclk=5,               # [assumed] HRM "SDRAM performance" as recalled, 8 SCLK a read, less CL 3; range 4..7
        store_buffer=5,                 # [assumed] range 4..8
    ),
    dma=DmaSpec(
        controllers=2,                  # Linux defBF561.h: DMA1 and DMA2
        mdma_streams=4,                 # the same: two of each controller
        word_bytes=4,                   # BF561 HRM ch. 9, DMA1; [assumed] for the memory DMA of DMA2
        fifo_words=4,                   # [assumed] range 4..8
        startup_sclk=15,                # [assumed] start-up and turn-round of a work unit, range 10..20
        descriptor_sclk=2,              # [assumed] per 16-bit element, besides what its memory takes
        read_word_sclk=Fraction(11, 10),  # [assumed] HRM table as recalled: MDMA read 1.1 SCLK a word
        on_chip_word_sclk=Fraction(1),  # HRM of the BF537, 5-50: internal memory DMA at the full SCLK rate
        imdma_word_cclk=2,              # [assumed] anomaly 05000182: never reaches its full speed of one word a CCLK
    ),
    ppi_fifo_words=8,                   # [assumed] 16 entries of 16 bits
    events=EventSpec(
        interrupt_entry_cclk=55,        # [assumed] pipeline flush 10, prologue in C 45 (range 30..60)
        interrupt_exit_cclk=50,         # epilogue [assumed] 45, RTI 5 (GNU sim)
        mmr_read_cclk=15,               # [assumed] 2 SCLK and a few CCLK, range 10..30
        mmr_write_cclk=1,               # posted
        testset_cclk=2,                 # GNU sim; its locked read of L2 comes on top
        spin_cclk=6,                    # branch back taken as predicted 5 (GNU sim), test of CC 1
    ),
    interrupts=Bf561Interrupt,
)  # fmt: skip
