"""CONFIG and TC_PER, bit by bit, and the table of channels with their addresses."""

from __future__ import annotations

import re
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.dma_channels import BF561_CHANNELS, Direction
from bfsim.chip.dma_registers import REGISTERS, Flow, WdSize
from bfsim.errors import BfsimError, MmrError
from bfsim.machine.dma.config import DmaConfig

configs = st.builds(
    DmaConfig,
    **{flag: st.booleans() for flag in ("DMAEN", "WNR", "DMA2D", "RESTART", "DI_SEL", "DI_EN")},
    WDSIZE=st.sampled_from(WdSize),
    NDSIZE=st.integers(0, 15),
    FLOW=st.sampled_from(Flow),
)


@given(configs)
def test_what_is_encoded_is_decoded(config: DmaConfig) -> None:
    """Every combination of fields comes back."""
    assert DmaConfig.decode(config.encode()) == config


def test_what_is_decoded_is_encoded() -> None:
    """All 16-bit values either come back or are refused, and three quarters times five eighths of one half are good."""
    good = 0
    for value in range(1 << 16):
        try:
            config = DmaConfig.decode(value)
        except MmrError:
            continue
        assert config.encode() == value
        good += 1
    assert good == (1 << 15) * 3 // 4 * 5 // 8


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"WDSIZE": 16}, r"CONFIG: WDSIZE must be one of WdSize\.WDSIZE_8, WdSize\.WDSIZE_16, .*, not 16"),
        ({"WDSIZE": 2}, "not 2$"),
        ({"FLOW": "AUTO"}, r"CONFIG: FLOW must be one of Flow\.STOP, Flow\.AUTO, .*, not 'AUTO'"),
        ({"DI_EN": 3}, "CONFIG: DI_EN must be True or False, not 3"),
        ({"NDSIZE": 16}, r"CONFIG: NDSIZE must be 0\.\.15, not 16"),
    ],
)
def test_fields_that_would_run_into_others_are_refused(fields: dict[str, Any], message: str) -> None:
    """WDSIZE=16 set DI_SEL, and moved bytes; 8 set RESTART."""
    with pytest.raises(MmrError, match=message):
        DmaConfig(**fields)


EZ_KIT_PPI = {"DMAEN": False, "WNR": True, "DMA2D": True, "DI_EN": True, "NDSIZE": 4, "FLOW": Flow.LARGE}


@pytest.mark.parametrize(
    ("value", "config"),
    [
        # a public dual-core video project for the BF561 EZ-KIT: 0x7000 | 0x400 | DI_EN | DMA2D | WDSIZE_32 | WNR
        (0x7000 | 0x400 | 0x80 | 0x10 | 0x08 | 0x02, DmaConfig(**EZ_KIT_PPI)),
        (0x749B, DmaConfig(**EZ_KIT_PPI | {"DMAEN": True})),
        # a public BF537 camera robot: large list, NDSIZE 5, 16 bits, 2-D, no interrupt
        (
            0x7517,
            DmaConfig(WNR=True, WDSIZE=WdSize.WDSIZE_16, DMA2D=True, NDSIZE=5, FLOW=Flow.LARGE),
        ),
        (0x0000, DmaConfig(DMAEN=False, WDSIZE=WdSize.WDSIZE_8)),
        (0x1061, DmaConfig(WDSIZE=WdSize.WDSIZE_8, RESTART=True, DI_SEL=True, FLOW=Flow.AUTO)),
    ],
)
def test_values_that_firmware_wrote(value: int, config: DmaConfig) -> None:
    """CONFIG values from public firmware, field by field."""
    assert DmaConfig.decode(value) == config
    assert config.encode() == value


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (0x000D, "CONFIG: WDSIZE must be 0 (WDSIZE_8), 1 (WDSIZE_16), 2 (WDSIZE_32), not the reserved 3"),
        *(
            (
                code << 12 | 1,
                f"CONFIG: FLOW must be 0 (STOP), 1 (AUTO), 4 (ARRAY), 6 (SMALL), 7 (LARGE), not the reserved {code}",
            )
            for code in (2, 3, 5)
        ),
        (0x8001, "CONFIG: bit 15 must be 0, not 1 in 0x8001"),
        (0x1_0000, "CONFIG must be 0..65535, not 65536"),
    ],
)
def test_reserved_codes_are_refused(value: int, message: str) -> None:
    """Codes without a meaning name their field; the register and the place are the caller's."""
    with pytest.raises(MmrError, match=f"^{re.escape(message)}$"):
        DmaConfig.decode(value)
    with pytest.raises(
        MmrError, match=re.escape(message.replace("CONFIG", "DMA1_0_CONFIG") + " (set at a.py:1)")
    ):
        DmaConfig.decode(value, "DMA1_0_CONFIG", "set at a.py:1")


def test_ndsize_has_four_bits() -> None:
    """16 elements cannot be written down."""
    with pytest.raises(MmrError, match=r"^CONFIG: NDSIZE must be 0\.\.15, not 16$"):
        DmaConfig(NDSIZE=16)


def test_programming_errors_are_value_errors_of_bfsim() -> None:
    """Callers may catch either parent."""
    assert issubclass(MmrError, BfsimError)
    assert issubclass(MmrError, ValueError)


def test_registers_of_each_channel() -> None:
    """36 channels of 13 registers; the four of the IMDMA have no PERIPHERAL_MAP."""
    for name, channel in BF561_CHANNELS.items():
        missing = {"PERIPHERAL_MAP"} if name.startswith("IMDMA") else set()
        assert set(channel.registers) == set(REGISTERS) - missing
    assert (len(BF561_CHANNELS), len(REGISTERS)) == (36, 13)


def test_channels_in_order_of_priority() -> None:
    """Peripherals by number, then memory stream 0 before 1; the PPIs come first, the SPI is the fifth of DMA2."""
    names = list(BF561_CHANNELS)
    assert names[:2] == ["DMA1_0", "DMA1_1"]
    assert names[12:16] == ["MDMA1_D0", "MDMA1_S0", "MDMA1_D1", "MDMA1_S1"]
    assert names[16:21] == ["DMA2_0", "DMA2_1", "DMA2_2", "DMA2_3", "DMA2_4"]
    assert [BF561_CHANNELS[each].serves for each in ("DMA1_0", "DMA1_1", "DMA2_4")] == ["PPI0", "PPI1", "SPI"]
    assert names[-4:] == ["IMDMA_D0", "IMDMA_S0", "IMDMA_D1", "IMDMA_S1"]


def test_destinations_write_and_sources_read() -> None:
    """The two halves of each memory stream."""
    for name, channel in BF561_CHANNELS.items():
        if channel.serves == "memory":
            assert channel.direction is (Direction.TO_MEMORY if "_D" in name else Direction.FROM_MEMORY)
