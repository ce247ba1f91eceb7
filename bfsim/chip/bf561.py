"""Timing of the ADSP-BF561. `grep assumed` lists every number without a document behind it."""

from __future__ import annotations

from fractions import Fraction

from bfsim.chip.memory_map import CM_BF561_REGIONS
from bfsim.chip.spec import ChipSpec

BF561 = ChipSpec(
    name="ADSP-BF561",
    cores=("A", "B"),
    regions=CM_BF561_REGIONS,
    l2_read_cclk=9,                     # [assumed] first 64 bits of an access, range 7..11; writes are posted
    core_sdram_read_sclk=8,             # [assumed] HRM "SDRAM performance" as recalled: 8 SCLK a word, range 7..10
    core_sdram_write_sclk=1,            # [assumed] same table: posted, one bus cycle on an open page
    mdma_startup_sclk=15,               # [assumed] start-up and turn-round of a work unit, range 10..20
    mdma_read_sclk=Fraction(11, 10),    # [assumed] HRM table as recalled: MDMA read 1.1 SCLK a word
    mdma_write_sclk=Fraction(1),        # [assumed] HRM table as recalled: MDMA write 1 SCLK a word
    ppi_word_sclk=Fraction(1),          # derived: PPI_CONTROL PACK_EN | DMA32, one 32-bit word per SCLK on an open page
    semaphore_issue_cclk=2,             # TESTSET, GNU sim; its L2 read comes on top
)  # fmt: skip
