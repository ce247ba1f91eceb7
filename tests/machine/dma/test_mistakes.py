"""What the chip flags: each mistake with its whole message, and what it leaves behind."""

from __future__ import annotations

import pytest

from bfsim.chip.dma_channels import Direction
from bfsim.chip.dma_registers import Flow, IrqStatus, WdSize
from bfsim.errors import MmrError
from bfsim.machine.dma.channel import DmaChannel, check_pair
from bfsim.machine.dma.config import DmaConfig
from bfsim.machine.dma.descriptors import write_descriptor
from tests.machine.dma.dma_rig import (
    DESCRIPTORS,
    L1_A,
    L2,
    PLACE,
    SCRATCH,
    SDRAM,
    UPPER_HALF_OF_A,
    Memory,
    channel_on,
    program,
)

FAILED = IrqStatus.DMA_ERR


def refusal(channel: DmaChannel, config: DmaConfig | int, place: str = PLACE) -> str:
    """What the channel says when it does not start; it is stopped then, with DMA_ERR set."""
    with pytest.raises(MmrError) as error:
        channel.start(config, place)
    assert channel.IRQ_STATUS == FAILED
    assert channel.unit is None
    return str(error.value)


def set_at(problem: str) -> str:
    return f"{problem} (set at {PLACE})"


def started_at(problem: str) -> str:
    return f"{problem} (started at {PLACE})"


@pytest.mark.parametrize(
    ("flow", "ndsize", "allowed"),
    [
        (Flow.LARGE, 0, "1..9"),
        (Flow.LARGE, 10, "1..9"),
        (Flow.SMALL, 0, "1..8"),
        (Flow.SMALL, 9, "1..8"),
        (Flow.ARRAY, 0, "1..7"),
        (Flow.ARRAY, 8, "1..7"),
        (Flow.STOP, 1, "0"),
        (Flow.AUTO, 4, "0"),
    ],
)
def test_ndsize_that_flow_cannot_use(flow: Flow, ndsize: int, allowed: str) -> None:
    """On both sides of each limit."""
    channel = program(channel_on(Memory(), "MDMA1_D0"))
    config = DmaConfig(WNR=True, FLOW=flow, NDSIZE=ndsize)
    problem = f"MDMA1_D0_CONFIG: FLOW={flow.name} requires NDSIZE {allowed}, not {ndsize}"
    assert refusal(channel, config) == set_at(problem)
    assert refusal(channel, config, place="") == problem


@pytest.mark.parametrize(
    ("config", "problem"),
    [
        (
            0x000F,
            "MDMA1_D0_CONFIG: WDSIZE must be 0 (WDSIZE_8), 1 (WDSIZE_16), 2 (WDSIZE_32), not the reserved 3",
        ),
        (
            0x500B,
            "MDMA1_D0_CONFIG: FLOW must be 0 (STOP), 1 (AUTO), 4 (ARRAY), 6 (SMALL), 7 (LARGE), not the reserved 5",
        ),
        (0x800B, "MDMA1_D0_CONFIG: bit 15 must be 0, not 1 in 0x800B"),
        (0x000A, "MDMA1_D0_CONFIG: DMAEN must be 1 to start the channel, not 0"),
        (0x0009, "MDMA1_D0_CONFIG: WNR must be 1, not 0: the channel writes memory for memory"),
    ],
)
def test_config_that_says_nothing_sensible(config: int, problem: str) -> None:
    """Reserved codes, the missing enable, and a destination that reads."""
    assert refusal(program(channel_on(Memory(), "MDMA1_D0")), config) == set_at(problem)


@pytest.mark.parametrize(
    ("name", "config", "problem"),
    [
        ("DMA2_1", 0x0007, "DMA2_1_CONFIG: WNR must be 0, not 1: the channel reads memory for SPORT0 TX"),
        ("DMA2_5", 0x0005, "DMA2_5_CONFIG: WNR must be 1, not 0: the channel writes memory for UART RX"),
        ("DMA2_4", 0x0009, "DMA2_4_CONFIG: WDSIZE must be 16 bits at most, not 32"),
    ],
)
def test_a_peripheral_that_works_otherwise(name: str, config: int, problem: str) -> None:
    """Its direction, and the 16 bits of DMA2."""
    assert refusal(program(channel_on(Memory(), name)), config) == set_at(problem)


def test_a_ppi_decides_its_direction() -> None:
    """PPI_CONTROL sets which way; before that both are right."""
    channel = program(channel_on(Memory(), "DMA1_0"))
    for config in (DmaConfig(WNR=True), DmaConfig(WNR=False)):
        channel.start(config)
        channel.stop()
    channel.direction = Direction.TO_MEMORY
    assert refusal(channel, DmaConfig(WNR=False)) == set_at(
        "DMA1_0_CONFIG: WNR must be 1, not 0: the channel writes memory for PPI0"
    )


FLAT, BLOCK = DmaConfig(WNR=True), DmaConfig(WNR=True, DMA2D=True)


@pytest.mark.parametrize(
    ("config", "registers", "problem"),
    [
        (
            FLAT,
            {"START_ADDR": SDRAM + 2},
            "DMA1_0_START_ADDR must be a multiple of 4 bytes with WDSIZE_32, not 0x00001002",
        ),
        (FLAT, {"X_MODIFY": 6}, "DMA1_0_X_MODIFY must be a multiple of 4 bytes with WDSIZE_32, not 6"),
        (
            BLOCK,
            {"Y_COUNT": 2, "Y_MODIFY": -2},
            "DMA1_0_Y_MODIFY must be a multiple of 4 bytes with WDSIZE_32, not -2",
        ),
        (
            DmaConfig(WNR=True, WDSIZE=WdSize.WDSIZE_16),
            {"START_ADDR": SDRAM + 1},
            "DMA1_0_START_ADDR must be a multiple of 2 bytes with WDSIZE_16, not 0x00001001",
        ),
    ],
)
def test_what_is_not_aligned(config: DmaConfig, registers: dict[str, int], problem: str) -> None:
    """Addresses and steps are multiples of the word."""
    assert refusal(program(channel_on(Memory()), **registers), config) == started_at(problem)


@pytest.mark.parametrize(
    ("config", "registers"),
    [
        (DmaConfig(WNR=True, WDSIZE=WdSize.WDSIZE_8), {"START_ADDR": SDRAM + 3, "X_MODIFY": 3}),
        (FLAT, {"X_COUNT": 1, "X_MODIFY": 3}),
        (FLAT, {"Y_COUNT": 2, "Y_MODIFY": 3}),
        (BLOCK, {"Y_COUNT": 1, "Y_MODIFY": 3}),
    ],
)
def test_steps_that_are_never_made_may_be_anything(config: DmaConfig, registers: dict[str, int]) -> None:
    """Bytes lie anywhere; a row of one word makes no step, nor does a single row; Y_MODIFY is for 2-D."""
    assert program(channel_on(Memory()), **registers).start(config).unit is not None


A_EXTENT = "COREA_L1_DATA_A, 0xFF800000..0xFF807FFF"


@pytest.mark.parametrize(
    ("name", "registers", "problem"),
    [
        (
            "DMA1_0",
            {"START_ADDR": 0x0200_0000},
            "DMA1_0_START_ADDR must point into a memory, not to 0x02000000 where there is none",
        ),
        (
            "DMA1_0",
            {"START_ADDR": SCRATCH},
            "DMA1_0_START_ADDR must point into a memory that DMA1 reaches, not to 0xFFB00000 in COREA_SCRATCH",
        ),
        (
            "IMDMA_D0",
            {"START_ADDR": SDRAM},
            "IMDMA_D0_START_ADDR must point into a memory that IMDMA reaches, not to 0x00001000 in SDRAM",
        ),
        (
            "DMA1_0",
            {"START_ADDR": 0xFF80_7F00, "X_COUNT": 65},
            f"DMA1_0_START_ADDR: what starts at 0xFF807F00 must stay in {A_EXTENT}, not take 0xFF807F00..0xFF808003",
        ),
        (
            "DMA1_0",
            {"START_ADDR": L1_A + 4, "X_COUNT": 3, "X_MODIFY": -4},
            f"DMA1_0_START_ADDR: what starts at 0xFF800004 must stay in {A_EXTENT}, not take 0xFF7FFFFC..0xFF800007",
        ),
        (
            "DMA1_0",
            {"START_ADDR": 0, "X_COUNT": 2, "X_MODIFY": -4},
            (
                "DMA1_0_START_ADDR: what starts at 0x00000000 must stay in SDRAM, 0x00000000..0x01FFFFFF, "
                "not take 0xFFFFFFFC..0x00000003"
            ),
        ),
        (
            "DMA1_0",
            {"START_ADDR": L1_A + 0x3FFC, "X_COUNT": 2},
            (
                "DMA1_0_START_ADDR: what starts at 0xFF803FFC must stay out of 0xFF804000..0xFF807FFF, which is cache, "
                "not take 0xFF803FFC..0xFF804003"
            ),
        ),
    ],
)
def test_what_lies_outside(name: str, registers: dict[str, int], problem: str) -> None:
    """No memory, one out of reach, over either end, and into the half that is cache."""
    channel = program(channel_on(Memory(), name, cached=(UPPER_HALF_OF_A,)), **registers)
    assert refusal(channel, FLAT) == started_at(problem)


@pytest.mark.parametrize(
    ("name", "registers"),
    [
        ("DMA1_0", {"START_ADDR": 0x01FF_FF00, "X_COUNT": 64}),
        ("DMA1_0", {"START_ADDR": L1_A + 4, "X_COUNT": 2, "X_MODIFY": -4}),
        ("DMA1_0", {"START_ADDR": L1_A + 0x3FFC, "X_COUNT": 1}),
        ("DMA1_0", {"START_ADDR": L1_A + 0x8000 - 640}),
        ("DMA1_0", {"START_ADDR": 0xFFA0_0000}),
        ("DMA1_0", {"START_ADDR": 0xFF61_0000}),
        ("DMA1_0", {"START_ADDR": 0x2C00_0000}),
        ("IMDMA_D0", {"START_ADDR": L2}),
    ],
)
def test_what_lies_just_inside(name: str, registers: dict[str, int]) -> None:
    """To the last byte; code memories of both cores, too, and both halves of L1 when neither is cache."""
    cached = (UPPER_HALF_OF_A,) if registers.get("X_COUNT") == 1 else ()
    assert program(channel_on(Memory(), name, cached), **registers).start(FLAT).unit is not None


LARGE = DmaConfig(WNR=True, FLOW=Flow.LARGE, NDSIZE=5)


@pytest.mark.parametrize(
    ("config", "registers", "problem"),
    [
        (
            LARGE,
            {"NEXT_DESC_PTR": DESCRIPTORS + 1},
            "DMA1_0_NEXT_DESC_PTR must be a multiple of 2 bytes, not 0xFF900001",
        ),
        (
            LARGE,
            {"NEXT_DESC_PTR": SCRATCH},
            "DMA1_0_NEXT_DESC_PTR must point into a memory that DMA1 reaches, not to 0xFFB00000 in COREA_SCRATCH",
        ),
        (
            LARGE,
            {"NEXT_DESC_PTR": 0xFEB1_FFF8},
            (
                "DMA1_0_NEXT_DESC_PTR: what starts at 0xFEB1FFF8 must stay in L2, 0xFEB00000..0xFEB1FFFF, "
                "not take 0xFEB1FFF8..0xFEB20001"
            ),
        ),
        (
            DmaConfig(WNR=True, FLOW=Flow.ARRAY, NDSIZE=7),
            {"CURR_DESC_PTR": 0xE000_0000},
            "DMA1_0_CURR_DESC_PTR must point into a memory, not to 0xE0000000 where there is none",
        ),
    ],
)
def test_descriptors_that_are_not_there(config: DmaConfig, registers: dict[str, int], problem: str) -> None:
    """Nothing is read from where no descriptor can be."""
    assert refusal(program(channel_on(Memory()), **registers), config) == started_at(problem)


def test_a_mistake_in_a_descriptor_names_the_descriptor_and_the_start() -> None:
    """The second of a chain; the firmware line is the one that started it."""
    memory = Memory()
    second = DESCRIPTORS + 0x20
    good = write_descriptor(Flow.LARGE, NEXT_DESC_PTR=second, START_ADDR=SDRAM, CONFIG=LARGE.encode())
    memory.put(DESCRIPTORS, good)
    memory.put(second, write_descriptor(Flow.LARGE, NEXT_DESC_PTR=0, START_ADDR=SDRAM, CONFIG=0x7003))
    channel = program(channel_on(memory), NEXT_DESC_PTR=DESCRIPTORS)
    channel.start(LARGE, PLACE)
    with pytest.raises(MmrError) as error:
        channel.unit_done()
    assert str(error.value) == (
        "DMA1_0_CONFIG: FLOW=LARGE requires NDSIZE 1..9, not 0 "
        f"(in the descriptor at 0xFF900020 of the chain started at {PLACE})"
    )
    assert channel.IRQ_STATUS == FAILED
    memory.put(
        second, write_descriptor(Flow.LARGE, NEXT_DESC_PTR=0, START_ADDR=SDRAM + 1, CONFIG=LARGE.encode())
    )
    channel.write("NEXT_DESC_PTR", DESCRIPTORS)
    channel.start(LARGE)
    with pytest.raises(MmrError) as error:
        channel.unit_done()
    assert str(error.value) == (
        "DMA1_0_START_ADDR must be a multiple of 4 bytes with WDSIZE_32, not 0x00001001 "
        "(in the descriptor at 0xFF900020)"
    )


def test_a_running_channel_refuses_to_be_programmed() -> None:
    """CONFIG and the parameters; it ends over it. Stopping is always allowed."""
    channel = program(channel_on(Memory()))
    channel.start(FLAT)
    assert refusal(channel, FLAT) == set_at(
        "DMA1_0_CONFIG must not be written with DMAEN=1 while the channel runs"
    )
    channel.acknowledge(IrqStatus.DMA_ERR)
    channel.start(FLAT)
    with pytest.raises(MmrError) as error:
        channel.write("X_COUNT", 5, PLACE)
    assert str(error.value) == set_at("DMA1_0_X_COUNT must not be written while the channel runs")
    assert (channel.X_COUNT, channel.IRQ_STATUS) == (160, FAILED)
    channel.start(FLAT)
    channel.stop()
    assert not channel.running


@pytest.mark.parametrize(
    ("register", "value", "problem"),
    [
        ("X_COUNT", 65536, "DMA1_0_X_COUNT must be 0..65535, not 65536"),
        ("Y_MODIFY", 32768, "DMA1_0_Y_MODIFY must be -32768..32767, not 32768"),
        ("START_ADDR", -1, "DMA1_0_START_ADDR must be 0..4294967295, not -1"),
        (
            "CURR_ADDR",
            0,
            (
                "a register that can be written must be one of NEXT_DESC_PTR, START_ADDR, X_COUNT, X_MODIFY, Y_COUNT, "
                "Y_MODIFY, CURR_DESC_PTR, not CURR_ADDR"
            ),
        ),
    ],
)
def test_what_no_register_holds(register: str, value: int, problem: str) -> None:
    """Too wide for the register, or no register of firmware's; the chip would not flag it."""
    channel = channel_on(Memory())
    with pytest.raises(MmrError) as error:
        channel.write(register, value, PLACE)
    assert str(error.value) == set_at(problem)
    assert not channel.IRQ_STATUS


def stream(
    source: dict[str, int], destination: dict[str, int], destination_size: WdSize
) -> tuple[DmaChannel, DmaChannel]:
    """The two halves of MDMA1 stream 0, started; the source moves 16-bit words."""
    halves = (
        program(channel_on(Memory(), "MDMA1_S0"), **source),
        program(channel_on(Memory(), "MDMA1_D0"), START_ADDR=L1_A, **destination),
    )
    halves[0].start(DmaConfig(WDSIZE=WdSize.WDSIZE_16, DMA2D=True))
    halves[1].start(DmaConfig(WNR=True, WDSIZE=destination_size), PLACE)
    return halves


def test_halves_of_a_stream_may_differ_in_shape() -> None:
    """20 rows of 8 words become one of 160."""
    check_pair(*stream({"X_COUNT": 8, "Y_COUNT": 20, "Y_MODIFY": 64}, {"X_COUNT": 160}, WdSize.WDSIZE_16))


@pytest.mark.parametrize(
    ("count", "size", "problem"),
    [
        (160, WdSize.WDSIZE_32, "must have the same WDSIZE, not 16 and 32 bits"),
        (159, WdSize.WDSIZE_16, "must move the same number of words, not 160 and 159"),
    ],
)
def test_halves_of_a_stream_must_agree(count: int, size: WdSize, problem: str) -> None:
    """Both are named, and the line that started the destination."""
    source, destination = stream({"X_COUNT": 8, "Y_COUNT": 20}, {"X_COUNT": count}, size)
    with pytest.raises(MmrError) as error:
        check_pair(source, destination)
    assert str(error.value) == started_at(f"MDMA1_S0 and MDMA1_D0 {problem}")
