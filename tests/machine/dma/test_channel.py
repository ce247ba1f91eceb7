"""A channel's life: which work unit follows which, what is fetched, and what IRQ_STATUS says meanwhile."""

from __future__ import annotations

import pytest

from bfsim.chip.dma_registers import Flow, IrqStatus, WdSize
from bfsim.machine.dma.channel import ChannelStep, DmaChannel, Fetch
from bfsim.machine.dma.config import DmaConfig
from bfsim.machine.dma.descriptors import write_descriptor
from tests.machine.dma.dma_rig import DESCRIPTORS, L1_A, SDRAM, Memory, channel_on, program

DONE, ERR, DFETCH, RUN = IrqStatus.DMA_DONE, IrqStatus.DMA_ERR, IrqStatus.DFETCH, IrqStatus.DMA_RUN
STOP = DmaConfig(WNR=True)


def start_of(step: ChannelStep) -> int:
    """The first address of the step's work unit."""
    assert step.unit is not None
    return step.unit.start_address


def current(channel: DmaChannel) -> tuple[int, int, int]:
    """Where the channel is in its work unit."""
    return channel.CURR_ADDR, channel.CURR_X_COUNT, channel.CURR_Y_COUNT


def test_stop_ends_after_one_unit() -> None:
    """RUN until the unit is done; without DI_EN nobody is told."""
    channel = program(channel_on(Memory()))
    first = channel.start(STOP)
    assert first.unit is not None
    assert first.fetch is None
    assert (first.unit.words, first.unit.write) == (160, True)
    assert channel.IRQ_STATUS == RUN
    assert channel.unit_done() == ChannelStep(None)
    assert not channel.IRQ_STATUS


def test_a_stopped_channel_starts_again_from_its_registers() -> None:
    """The programming is still there, and can be changed."""
    channel = program(channel_on(Memory()))
    first = channel.start(STOP)
    channel.unit_done()
    assert channel.start(STOP) == first
    channel.unit_done()
    channel.write("START_ADDR", L1_A)
    assert start_of(channel.start(STOP)) == L1_A


def test_config_is_written_as_a_number_or_by_its_fields() -> None:
    """Both are the same register."""
    config = DmaConfig(WNR=True, DMA2D=True, DI_EN=True)
    by_fields, by_number = (program(channel_on(Memory()), Y_COUNT=2, Y_MODIFY=4) for _ in range(2))
    assert by_fields.start(config) == by_number.start(config.encode())
    assert by_fields.CONFIG == by_number.CONFIG == config.encode()
    assert by_fields.config == by_number.config == config


def test_autobuffer_goes_on_without_fetching() -> None:
    """The same unit again and again, each with its interrupt, until it is stopped."""
    channel = program(channel_on(Memory()))
    first = channel.start(DmaConfig(FLOW=Flow.AUTO, DI_EN=True))
    for _ in range(3):
        again = channel.unit_done()
        assert again == ChannelStep(first.unit, fetch=None, interrupt=True)
        assert channel.IRQ_STATUS == RUN | DONE
    channel.stop()
    assert channel.IRQ_STATUS == DONE
    assert channel.unit is None


def test_a_ring_of_pointers() -> None:
    """Large list, NDSIZE 4 = {next, start}: two frame buffers in turn, everything else from the registers."""
    memory = Memory()
    here, there = DESCRIPTORS, DESCRIPTORS + 8
    memory.put(here, write_descriptor(Flow.LARGE, NEXT_DESC_PTR=there, START_ADDR=SDRAM))
    memory.put(there, write_descriptor(Flow.LARGE, NEXT_DESC_PTR=here, START_ADDR=0x0080_0000))
    channel = program(
        channel_on(memory), NEXT_DESC_PTR=here, X_COUNT=320, X_MODIFY=4, Y_COUNT=480, Y_MODIFY=4
    )
    step = channel.start(0x749B)
    for _ in range(2):
        assert (start_of(step), step.fetch) == (SDRAM, Fetch(here, 4))
        assert (there, here + 8) == (channel.NEXT_DESC_PTR, channel.CURR_DESC_PTR)
        step = channel.unit_done()
        assert step.interrupt
        assert (start_of(step), step.fetch) == (0x0080_0000, Fetch(there, 4))
        assert step.unit is not None
        assert step.unit.nbytes == 640 * 480 * 2
        step = channel.unit_done()


def test_a_small_list_stays_in_its_64_kb() -> None:
    """The upper half of NEXT_DESC_PTR is the one that firmware wrote."""
    memory = Memory()
    memory.put(DESCRIPTORS, write_descriptor(Flow.SMALL, NEXT_DESC_PTR=DESCRIPTORS + 0x40, START_ADDR=SDRAM))
    memory.put(DESCRIPTORS + 0x40, write_descriptor(Flow.SMALL, NEXT_DESC_PTR=DESCRIPTORS, START_ADDR=L1_A))
    channel = program(channel_on(memory), NEXT_DESC_PTR=DESCRIPTORS)
    steps = [channel.start(DmaConfig(FLOW=Flow.SMALL, NDSIZE=3)), channel.unit_done(), channel.unit_done()]
    assert [start_of(each) for each in steps] == [SDRAM, L1_A, SDRAM]
    assert [each.fetch for each in steps] == [
        Fetch(DESCRIPTORS, 3),
        Fetch(DESCRIPTORS + 0x40, 3),
        Fetch(DESCRIPTORS, 3),
    ]


def test_an_array_is_read_from_curr_desc_ptr_on() -> None:
    """Descriptors lie side by side, and NEXT_DESC_PTR has no part in it; the one with FLOW STOP is the last."""
    memory = Memory()
    on, end = DmaConfig(FLOW=Flow.ARRAY, NDSIZE=4), DmaConfig(DI_EN=True)
    units = [(SDRAM, on, 10), (L1_A, on, 20), (SDRAM + 64, end, 30)]
    words = [
        word
        for start, config, count in units
        for word in write_descriptor(Flow.ARRAY, START_ADDR=start, CONFIG=config.encode(), X_COUNT=count)
    ]
    memory.put(DESCRIPTORS, words)
    channel = program(channel_on(memory), CURR_DESC_PTR=DESCRIPTORS)
    steps = [channel.start(on), channel.unit_done(), channel.unit_done(), channel.unit_done()]
    assert [each.unit and (each.unit.start_address, each.unit.words) for each in steps] == [
        (SDRAM, 10),
        (L1_A, 20),
        (SDRAM + 64, 30),
        None,
    ]
    assert [each.fetch for each in steps] == [
        *(Fetch(DESCRIPTORS + 8 * number, 4) for number in range(3)),
        None,
    ]
    assert [each.interrupt for each in steps] == [False, False, False, True]
    assert (channel.CURR_DESC_PTR, channel.IRQ_STATUS) == (DESCRIPTORS + 24, DONE)


def test_a_chain_that_stopped_goes_on_with_its_next_descriptor() -> None:
    """The pointer had been loaded before the unit with FLOW STOP ran."""
    memory = Memory()
    config = DmaConfig(FLOW=Flow.LARGE, NDSIZE=5)
    last = {"CONFIG": DmaConfig().encode()}
    memory.put(
        DESCRIPTORS, write_descriptor(Flow.LARGE, NEXT_DESC_PTR=DESCRIPTORS + 10, START_ADDR=SDRAM, **last)
    )
    memory.put(DESCRIPTORS + 10, write_descriptor(Flow.LARGE, NEXT_DESC_PTR=0, START_ADDR=L1_A, **last))
    channel = program(channel_on(memory), NEXT_DESC_PTR=DESCRIPTORS)
    assert start_of(channel.start(config)) == SDRAM
    assert channel.unit_done() == ChannelStep(None)
    assert start_of(channel.start(config)) == L1_A


def test_a_descriptor_without_dmaen_stops_the_channel() -> None:
    """It is fetched, and nothing moves."""
    memory = Memory()
    off = DmaConfig(DMAEN=False, FLOW=Flow.ARRAY, NDSIZE=3)
    memory.put(DESCRIPTORS, write_descriptor(Flow.ARRAY, START_ADDR=SDRAM, CONFIG=off.encode()))
    channel = program(channel_on(memory), CURR_DESC_PTR=DESCRIPTORS)
    assert channel.start(DmaConfig(FLOW=Flow.ARRAY, NDSIZE=3)) == ChannelStep(None, Fetch(DESCRIPTORS, 3))
    assert not channel.IRQ_STATUS


def test_a_descriptor_can_change_the_shape_of_the_next_ones() -> None:
    """FLOW and NDSIZE of a fetched CONFIG hold for the fetch after it: from a large list into autobuffer."""
    memory = Memory()
    auto = DmaConfig(FLOW=Flow.AUTO, WDSIZE=WdSize.WDSIZE_16)
    memory.put(
        DESCRIPTORS, write_descriptor(Flow.LARGE, NEXT_DESC_PTR=0, START_ADDR=L1_A + 2, CONFIG=auto.encode())
    )
    channel = program(channel_on(memory), NEXT_DESC_PTR=DESCRIPTORS)
    first = channel.start(DmaConfig(FLOW=Flow.LARGE, NDSIZE=5))
    assert first.unit is not None
    assert (first.unit.word_bytes, first.unit.words) == (2, 160)
    assert channel.unit_done() == ChannelStep(first.unit)


def test_rows_and_their_interrupts() -> None:
    """With DI_SEL each of three rows asks once; the current registers follow row by row."""
    channel = program(channel_on(Memory()), X_COUNT=4, Y_COUNT=3, Y_MODIFY=20)
    channel.start(DmaConfig(DMA2D=True, DI_EN=True, DI_SEL=True))
    assert current(channel) == (SDRAM, 4, 3)
    for rows_left, address in ((2, SDRAM + 32), (1, SDRAM + 64)):
        assert channel.row_done()
        assert current(channel) == (address, 4, rows_left)
        assert channel.IRQ_STATUS == RUN | DONE
        channel.acknowledge(DONE)
    assert channel.unit_done() == ChannelStep(None, interrupt=True)
    assert current(channel) == (SDRAM + 80, 0, 1)
    assert channel.IRQ_STATUS == DONE


def test_rows_of_a_block_are_silent() -> None:
    """Without DI_SEL only the end of the block asks."""
    channel = program(channel_on(Memory()), Y_COUNT=2, Y_MODIFY=4)
    channel.start(DmaConfig(DMA2D=True, DI_EN=True))
    assert not channel.row_done()
    assert channel.IRQ_STATUS == RUN
    assert channel.unit_done().interrupt


def test_dfetch_is_set_until_the_descriptor_has_arrived() -> None:
    """Who keeps the time says when."""
    memory = Memory()
    memory.put(DESCRIPTORS, write_descriptor(Flow.LARGE, NEXT_DESC_PTR=DESCRIPTORS, START_ADDR=SDRAM))
    channel = program(channel_on(memory), NEXT_DESC_PTR=DESCRIPTORS)
    channel.start(DmaConfig(FLOW=Flow.LARGE, NDSIZE=4))
    assert channel.IRQ_STATUS == RUN | DFETCH
    channel.fetched()
    assert channel.IRQ_STATUS == RUN
    channel.unit_done()
    assert channel.IRQ_STATUS == RUN | DFETCH


def test_only_done_and_err_are_cleared_by_a_write() -> None:
    """Writing ones to RUN does nothing, nor writing zeros to DONE."""
    channel = program(channel_on(Memory()))
    channel.start(DmaConfig(FLOW=Flow.AUTO, DI_EN=True))
    channel.unit_done()
    channel.acknowledge(RUN | ERR)
    assert channel.IRQ_STATUS == RUN | DONE
    channel.acknowledge(DONE | RUN)
    assert channel.IRQ_STATUS == RUN


@pytest.mark.parametrize(("name", "value"), [("DMA1_1", 0x1000), ("DMA2_4", 0x4000), ("MDMA1_S0", 0x0040)])
def test_peripheral_map_after_reset(name: str, value: int) -> None:
    """The channel's own number, or CTYPE for memory."""
    channel = channel_on(Memory(), name)
    assert value == channel.PERIPHERAL_MAP
