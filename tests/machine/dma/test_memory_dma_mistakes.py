"""What the chip flags in the programming of memory DMA, and the line of the firmware that is told with it."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import pytest

from bfsim.api import Buffer, Core, Firmware, Frame, FrameSize, u8
from bfsim.chip.boards import CM_BF533
from bfsim.chip.dma_registers import Flow, WdSize
from bfsim.errors import FirmwareError, MmrError
from bfsim.linker import link
from bfsim.machine.board import Board
from bfsim.machine.dma.config import DmaConfig
from bfsim.machine.symbols import symbols_of
from tests.machine.kernels import spin
from tests.machine.made_boards import play
from tests.machine.placements import shipped
from tests.machine.rig import SIZE, Play, every_frame
from tests.machine.rig import noise as pictures
from tests.machine.stream_rig import (
    MORE,
    READ,
    WRITE,
    chain,
    linear,
    noise,
)


def mistake(
    source: Mapping[str, int], destination: Mapping[str, int], configs: tuple[DmaConfig, DmaConfig] = (READ, WRITE),
    stream: str = "MDMA1_0",
) -> tuple[str, int]:  # fmt: skip
    """Program what is wrong; return the message without this file's name, and the line of `program`."""
    lines = []

    def work(core: Core, frame: Frame) -> Play:
        dma = core.memory_dma(stream)
        here, there = core.array("from_L1"), core.array("to_L1")
        inward, outward = linear(here.address, 8), linear(there.address, 8)
        dma.program(source={**inward, **source}, destination={**outward, **destination})
        yield from dma.start(*configs)
        yield from dma.wait()

    lines.append(work.__code__.co_firstlineno + 4)
    with pytest.raises(MmrError) as caught:
        play(every_frame(work), more=MORE)
    return str(caught.value).replace(__file__, "here"), lines[0]


@pytest.mark.parametrize(
    ("source", "destination", "message"),
    [
        ({"X_COUNT": 65536}, {}, "MDMA1_S0_X_COUNT must be .* not 65536"),
        ({"X_MODIFY": 40_000}, {}, "MDMA1_S0_X_MODIFY must be .* not 40000"),
        ({}, {"X_COUNT": 2.5}, "MDMA1_D0_X_COUNT must be an integer, not 2.5"),
        (
            {"START_ADDR": "camera"},
            {},
            "MDMA1_S0_START_ADDR must be an integer, such as row.address, not 'camera'",
        ),
        ({}, {"CURR_X_COUNT": 1}, "a register that can be written must be one of .*, not CURR_X_COUNT"),
    ],
)
def test_a_wrong_register_is_told_with_the_line_that_sets_it(
    source: dict[str, Any], destination: dict[str, Any], message: str
) -> None:
    """Channel, register, value, and the firmware's line."""
    told, line = mistake(source, destination)
    assert re.match(rf"{message} \(set at here:{line}\)", told), told


@pytest.mark.parametrize(
    ("source", "destination", "configs", "message"),
    [
        ({"START_ADDR": 0x2}, {}, (READ, WRITE), "MDMA1_S0_START_ADDR must be a multiple of 4 bytes with WDSIZE_32, not 0x"),
        ({"START_ADDR": 0x3000_0000}, {}, (READ, WRITE), "MDMA1_S0_START_ADDR must point into a memory, not to"),
        ({}, {"START_ADDR": 0xFFB0_0000}, (READ, WRITE), "MDMA1_D0_START_ADDR must point into a memory that DMA1 reaches"),
        ({}, {"X_MODIFY": 32_000}, (READ, WRITE), "MDMA1_D0_START_ADDR: what starts at .* must stay in"),
        ({"X_COUNT": 7}, {}, (READ, WRITE), "MDMA1_S0 and MDMA1_D0 must move the same number of words, not 7 and 8"),
        (
            {}, {}, (DmaConfig(WDSIZE=WdSize.WDSIZE_16), WRITE),
            "MDMA1_S0 and MDMA1_D0 must have the same WDSIZE, not 16 and 32 bits",
        ),
        ({}, {}, (WRITE, WRITE), "MDMA1_S0_CONFIG: WNR must be 0, not 1"),
        ({}, {}, (READ, READ), "MDMA1_D0_CONFIG: WNR must be 1, not 0"),
        ({}, {}, (DmaConfig(NDSIZE=3), WRITE), "MDMA1_S0_CONFIG: FLOW=STOP requires NDSIZE 0, not 3"),
    ],
)  # fmt: skip
def test_wrong_work_is_told_with_the_line_that_starts_it(
    source: dict[str, int], destination: dict[str, int], configs: tuple[DmaConfig, DmaConfig], message: str
) -> None:
    """Whatever the chip would set DMA_ERR for."""
    told, line = mistake(source, destination, configs)
    assert re.match(message, told), told
    assert re.search(rf"\((set|started) at here:{line + 1}\)", told), told


def test_a_bad_descriptor_is_told_with_its_address_and_the_line_of_the_start() -> None:
    """The second one of a chain, fetched long after the start."""
    address = []

    def work(core: Core, frame: Frame) -> Play:
        here, there, descriptors = core.array("from_L1"), core.array("to_L1"), core.array("chain_L1")
        pieces = [linear(here.address, 8), linear(here.address + 1, 8)]
        source = chain(Flow.LARGE, descriptors.address, pieces)
        descriptors.array[: len(source)] = source
        address.append(descriptors.address + len(source))
        dma = core.memory_dma("MDMA1_0")
        dma.program(source={"NEXT_DESC_PTR": descriptors.address}, destination=linear(there.address, 8))
        yield from dma.start(DmaConfig(FLOW=Flow.LARGE, NDSIZE=7), DmaConfig(FLOW=Flow.AUTO, WNR=True))
        yield from dma.wait()

    with pytest.raises(MmrError) as caught:
        play(every_frame(work), more=MORE)
    line = work.__code__.co_firstlineno + 8
    assert re.match("MDMA1_S0_START_ADDR must be a multiple of 4 bytes", str(caught.value))
    expected = f"(in the descriptor at 0x{address[0]:08X} of the chain started at {__file__}:{line})"
    assert expected in str(caught.value)


def test_a_chain_that_nobody_wrote_is_told() -> None:
    """Zeros say that the channel stops; the other one would wait for ever. It was an assertion of bfsim's own."""

    def work(core: Core, frame: Frame) -> Play:
        dma = core.memory_dma("MDMA1_0")
        dma.program(source={"CURR_DESC_PTR": core.array("chain_L1").address}, destination={})
        yield from dma.start(DmaConfig(FLOW=Flow.ARRAY, NDSIZE=5), WRITE)

    line = work.__code__.co_firstlineno + 3
    message = rf"^MDMA1_S0_CONFIG: DMAEN must be 1 where the stream begins, not 0 \(in the descriptor at 0x\w+ of the chain started at {__file__}:{line}\)"
    with pytest.raises(MmrError, match=message):
        play(every_frame(work), more=MORE)


def test_the_internal_dma_does_not_reach_sdram() -> None:
    """L1 of a core and L2 only."""
    told, line = mistake({"START_ADDR": 0x1000}, {}, stream="IMDMA_1")
    assert told.startswith(
        "IMDMA_S1_START_ADDR must point into a memory that IMDMA reaches, not to 0x00001000 in SDRAM"
    )
    assert f"here:{line + 1}" in told


def test_the_internal_dma_takes_words_from_the_other_core_s_l1() -> None:
    """What no load or store of a core can reach: from L1 of core A to L1 of core B."""
    seen = []
    addresses = []

    def give(core: Core, frame: Frame) -> Play:
        yield from core.wait("address")
        here = core.array("from_L1")
        here.array[:] = noise()
        dma = core.memory_dma("IMDMA_0")
        dma.program(source=linear(here.address, 8), destination=linear(addresses[0], 8))
        yield from dma.start(READ, WRITE)
        yield from dma.wait()
        yield from core.post("there")

    def take(core: Core, frame: Frame) -> Play:
        words = core.array("words")
        addresses.append(words.address)
        yield from core.post("address")
        yield from core.wait("there")
        seen.append(words.octets[:32].tobytes())

    play(every_frame(give), every_frame(take), more=MORE)
    assert seen == [noise()[:32].tobytes()]


def test_an_unknown_stream_is_told_the_known_ones() -> None:
    """By the names of their interrupts."""

    def work(core: Core, frame: Frame) -> Play:
        core.memory_dma("MDMA3_0")
        yield core.run(spin, 1)

    with pytest.raises(
        FirmwareError, match="must be one of MDMA1_0, .*IMDMA_1, not 'MDMA3_0' .*test_memory_dma_mistakes.py:"
    ):
        play(every_frame(work), more=MORE)


def test_registers_of_a_running_stream_must_not_be_written() -> None:
    """Nor can it be started twice."""

    def work(core: Core, frame: Frame) -> Play:
        dma = core.memory_dma("MDMA1_0")
        here, there = core.array("from_L1"), core.array("to_L1")
        for _ in range(2):
            dma.program(source=linear(here.address, 8), destination=linear(there.address, 8))
            yield from dma.start(READ, WRITE)

    line = work.__code__.co_firstlineno + 4
    with pytest.raises(MmrError, match=f"MDMA1_S0_START_ADDR must not be written while .*py:{line}"):
        play(every_frame(work), more=MORE)


@pytest.mark.parametrize("name", ["MDMA2_0", "IMDMA_0"])
def test_a_chip_has_its_own_streams_only(name: str) -> None:
    """The BF533 has one controller, and no internal DMA."""

    def buffers(size: FrameSize) -> dict[str, Sequence[Buffer]]:
        return {"A": (Buffer("camera", u8, 2 * size.width_px, "sdram_bank0", rows=3 * size.height_px),)}

    def work(core: Core, frame: Frame) -> Play:
        yield from core.memory_dma(name).wait()

    firmware = Firmware(mains={"A": every_frame(work)}, buffers=buffers, camera="camera", rows=())
    chip = CM_BF533.chip
    link_map = link(shipped("cm-bf533.ldf"), symbols_of(firmware, SIZE), chip.regions, chip=chip.name)
    with pytest.raises(FirmwareError, match=f"must be one of MDMA1_0, MDMA1_1, not '{name}'"):
        Board(CM_BF533, firmware, SIZE, link_map).run(pictures(1))
