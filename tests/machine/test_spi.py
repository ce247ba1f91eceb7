"""SPI: how long messages take, what arrives at the other end, what comes in, and what is refused."""

from __future__ import annotations

import itertools
from binascii import crc_hqx
from dataclasses import replace
from fractions import Fraction
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import Buffer, Core, Frame, u16
from bfsim.chip.boards import CM_BF561, CM_BF561_RATINGS
from bfsim.chip.spec import BoardSpec
from bfsim.cli import main
from bfsim.errors import FirmwareError
from bfsim.machine.board import Outcome
from bfsim.machine.spi.protocol import Message, MessageError, MessageType, encode, message_nbytes
from bfsim.machine.spi.strategy import ScriptedBytes, ScriptedMessage
from bfsim.trace import MessageRecord, StallReason
from tests.machine.kernels import spin
from tests.machine.made_boards import CHIP, assert_accounted, cclk_now, in_work, made_board
from tests.machine.rig import Play, cycles_of, every_frame, noise, stage_of

ROOM_BYTES = 8192
MORE = (
    Buffer("message", u16, ROOM_BYTES // 2, "L1_data_a"),
    Buffer("far", u16, ROOM_BYTES // 2, "sdram_bank2"),
)
WRITES = 5  # SPI_CTL, and START_ADDR, X_COUNT, X_MODIFY and CONFIG
SETUP_CCLK = WRITES * CHIP.events.mmr_write_cclk
GAP_SCK = 1
PAYLOADS = st.binary(max_size=300)


def put(core: Core, message: Message, buffer: str = "message") -> int:
    """Write a message to a buffer of the core; return its bytes."""
    octets = encode(message)
    core.array(buffer).octets[: len(octets)] = octets
    return len(octets)


def results(sequence: int, payload: bytes = b"edges") -> Message:
    """A message to the strategy unit."""
    return Message(MessageType.RESULTS, sequence, payload)


def wire_cclk(nbytes: int, spec: BoardSpec = CM_BF561) -> Fraction:
    """Cycles of so many bytes on the wire: 16 bits and the gap behind each word, at the rate that BAUD makes."""
    clocks = spec.clocks
    baud = max(2, ceil(clocks.sclk_hz / spec.spi_clk_hz / 2))
    sck_cclk = clocks.cclk_hz / (clocks.sclk_hz / (2 * baud))
    return nbytes // 2 * (16 + GAP_SCK) * sck_cclk


def run(main_a: Any, main_b: Any = None, *, frames: int = 1, **made: Any) -> tuple[Outcome, list[Message]]:
    """Run firmware; return the outcome and what the strategy unit received."""
    mains = (main_a,) if main_b is None else (main_a, main_b)
    board = made_board(*mains, more=MORE, **made)
    outcome = board.run(noise(frames, board.size))
    assert_accounted(outcome)
    return outcome, [each.message for each in board._spi._strategy.received]


@pytest.mark.parametrize("spi_mhz", [1, 10, 20, 50])
@pytest.mark.parametrize("board", [CM_BF561, CM_BF561_RATINGS], ids=lambda each: each.name)
@pytest.mark.parametrize("payload", [0, 1, 8, 100])
def test_words_and_gaps_make_the_time_on_the_wire(payload: int, board: BoardSpec, spi_mhz: int) -> None:
    """From the SCLK edge behind the last register write to the last word's gap; SCK is at most a quarter of SCLK."""
    spec = replace(board, spi_clk_hz=Fraction(spi_mhz * 1_000_000))
    written = []

    def work(core: Core, frame: Frame) -> Play:
        nbytes = put(core, results(7, bytes(payload)))
        yield from core.send(core.array("message"), nbytes)
        written.append(core.now_ticks)

    outcome, received = run(every_frame(work), spec=spec)
    nbytes = message_nbytes(payload)
    assert received == [results(7, bytes(payload))]
    clocks = spec.clocks
    edge_ticks = ceil(Fraction(written[0], clocks.sclk_ticks)) * clocks.sclk_ticks
    end_cclk = ceil(Fraction(edge_ticks, clocks.cclk_ticks) + wire_cclk(nbytes, spec))
    assert outcome.messages == (
        MessageRecord(
            direction="out",
            type="RESULTS",
            sequence=7,
            nbytes=nbytes,
            begin_cclk=written[0] // clocks.cclk_ticks,
            end_cclk=end_cclk,
        ),
    )


@settings(max_examples=30)
@given(st.lists(PAYLOADS, min_size=1, max_size=4), st.sampled_from(["message", "far"]))
def test_every_message_arrives_as_it_was_sent(payloads: list[bytes], buffer: str) -> None:
    """Of any content and size, from L1 and from SDRAM, in order."""
    sent = [results(number, each) for number, each in enumerate(payloads)]

    def work(core: Core, frame: Frame) -> Play:
        for each in sent:
            if core._spi.busy is not None:
                yield core._spi.busy  # the buffer is in use
            yield from core.send(core.array(buffer), put(core, each, buffer))

    _, received = run(every_frame(work))
    assert received == sent


def test_the_core_goes_on_and_the_next_message_waits() -> None:
    """Sending costs the register writes; a second message in a row waits until the first is out."""

    def work(core: Core, frame: Frame) -> Play:
        nbytes = put(core, results(1))
        yield from core.send(core.array("message"), nbytes)
        yield core.run(spin, 10)
        yield from core.send(core.array("message"), nbytes)

    outcome, received = run(in_work(work))
    assert len(received) == 2
    waited = wire_cclk(message_nbytes(5)) - cycles_of(spin, 10)
    assert stage_of(outcome.frames[0], "Work").stall_cclk == {
        StallReason.DMA_SETUP: 2 * SETUP_CCLK,
        StallReason.RING_FULL: waited,
    }
    first, second = outcome.messages
    assert second.begin_cclk == first.end_cclk + SETUP_CCLK


def test_a_frame_later_nothing_waits() -> None:
    """A message a frame: the wire is long free."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.send(core.array("message"), put(core, results(frame.index)))

    outcome, received = run(in_work(work), frames=3)
    assert [each.sequence for each in received] == [0, 1, 2]
    for frame in outcome.frames:
        assert stage_of(frame, "Work").stall_cclk == {StallReason.DMA_SETUP: SETUP_CCLK}


def test_both_cores_may_send_at_the_same_time() -> None:
    """One wire: the messages go out one after the other, and both are whole."""

    def sending(sequence: int) -> Any:
        def work(core: Core, frame: Frame) -> Play:
            row = core.array("message" if core.name == "A" else "words")
            octets = encode(results(sequence))
            row.octets[: len(octets)] = octets
            yield from core.send(row, len(octets))
            yield from core.send(row, len(octets))

        return every_frame(work)

    outcome, received = run(sending(1), sending(2))
    assert sorted(each.sequence for each in received) == [1, 1, 2, 2]
    times = [(each.begin_cclk, each.end_cclk) for each in outcome.messages]
    assert all(end <= begin for (_, end), (begin, _) in itertools.pairwise(times))
    for begin, end in times:
        assert end - begin == wire_cclk(message_nbytes(5))


def test_every_core_with_a_handler_is_interrupted() -> None:
    """When the DMA of the SPI is done, each core's own interrupt controller sees it."""
    handled = []

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("SPI_DMA", lambda core: handled.append(core.name))
        if core.name == "A":
            yield from core.send(core.array("message"), put(core, results(1)))
        yield from core.idle()

    outcome, _ = run(every_frame(work), every_frame(work))
    assert sorted(handled) == ["A", "B"]
    assert outcome.interrupts == {"A SPI_DMA": 1, "B SPI_DMA": 1}


# ---- messages in

SCRIPT = (
    ScriptedMessage(after_frames=0, type=MessageType.MODE, payload=b"first"),
    ScriptedMessage(after_frames=2, type=MessageType.MODELS, payload=b"second one"),
    ScriptedMessage(after_frames=2, type=MessageType.MODE, payload=b""),
)


def test_what_the_script_says_comes_in_after_its_frame() -> None:
    """Once so many results are out the firmware gets it, before that nothing; each message once, in order."""
    got: list[tuple[int, bytes]] = []

    def work(core: Core, frame: Frame) -> Play:
        row = core.array("message")
        while nbytes := (yield from core.receive(row)):
            got.append((frame.index, row.octets[:nbytes].tobytes()))
        yield from core.send(row, put(core, results(frame.index)))

    outcome, _ = run(every_frame(work), frames=4, script=SCRIPT)
    assert got == [
        (0, encode(Message(MessageType.MODE, 0, b"first"))),
        (2, encode(Message(MessageType.MODELS, 1, b"second one"))),
        (2, encode(Message(MessageType.MODE, 2, b""))),
    ]
    incoming = [each for each in outcome.messages if each.direction == "in"]
    assert [(each.type, each.sequence) for each in incoming] == [("MODE", 0), ("MODELS", 1), ("MODE", 2)]
    assert outcome.untaken == ()


@pytest.mark.parametrize(("frames", "untaken"), [(1, (2, 2, 9)), (2, (2, 2, 9)), (3, (9,))])
def test_what_comes_after_the_last_frame_is_told(frames: int, untaken: tuple[int, ...]) -> None:
    """What was not due yet, and what was due when nobody asked any more."""

    def work(core: Core, frame: Frame) -> Play:
        row = core.array("message")
        while (yield from core.receive(row)):
            pass
        yield from core.send(row, put(core, results(frame.index)))

    late = ScriptedBytes(after_frames=9, octets=b"late")
    outcome, _ = run(every_frame(work), frames=frames, script=(late, *SCRIPT))
    assert outcome.untaken == untaken


def test_a_message_in_is_waited_for_and_an_empty_wire_is_not() -> None:
    """Register writes and the time on the wire; when there is nothing, nothing is paid."""
    times = []

    def work(core: Core, frame: Frame) -> Play:
        row = core.array("message")
        times.append(cclk_now(core))
        assert (yield from core.receive(row)) == message_nbytes(5)
        times.append(cclk_now(core))
        assert (yield from core.receive(row)) == 0
        times.append(cclk_now(core))

    outcome, _ = run(in_work(work), script=SCRIPT[:1])
    before, got, nothing = times
    wire = wire_cclk(message_nbytes(5))
    assert (got - before, nothing - got) == (SETUP_CCLK + wire, 0)
    assert stage_of(outcome.frames[0], "Work").stall_cclk == {
        StallReason.DMA_SETUP: SETUP_CCLK,
        StallReason.RING_EMPTY: wire,
    }
    (record,) = outcome.messages
    assert (record.begin_cclk, record.end_cclk) == (before + SETUP_CCLK, got)


def test_two_cores_take_one_message_once() -> None:
    """Both look at the same time; one of them gets it, and the other one nothing."""
    got = []

    def work(core: Core, frame: Frame) -> Play:
        row = core.array("message" if core.name == "A" else "words")
        got.append((yield from core.receive(row)))

    run(every_frame(work), every_frame(work), script=SCRIPT[:1])
    assert sorted(got) == [0, message_nbytes(5)]


def test_what_has_no_room_is_lost() -> None:
    """The DMA takes as many words as the buffer has; the rest goes by, and the next message is whole."""
    got = []

    def work(core: Core, frame: Frame) -> Play:
        for row in (core.rows("short_ring")[0], core.array("message")):
            nbytes = yield from core.receive(row)
            got.append(row.octets[:nbytes].tobytes())

    long = ScriptedMessage(after_frames=0, type=MessageType.MODE, payload=bytes(100))
    outcome, _ = run(every_frame(work), script=(long, SCRIPT[0]))
    assert got == [
        encode(Message(MessageType.MODE, 0, bytes(100)))[:16],
        encode(Message(MessageType.MODE, 1, b"first")),
    ]
    assert [(each.type, each.nbytes) for each in outcome.messages] == [("damaged", 16), ("MODE", 16)]


def test_bytes_that_are_no_message_come_in_too() -> None:
    """It is the firmware's to find out; the records call them damaged."""
    got = []

    def work(core: Core, frame: Frame) -> Play:
        row = core.array("message")
        nbytes = yield from core.receive(row)
        got.append(row.octets[:nbytes].tobytes())
        yield core.run(spin, 1)

    outcome, _ = run(every_frame(work), script=(ScriptedBytes(after_frames=0, octets=b"no message"),))
    assert got == [b"no message"]
    assert [(each.type, each.sequence, each.nbytes) for each in outcome.messages] == [("damaged", 0, 10)]


# ---- what is refused


@pytest.mark.parametrize(
    ("buffer", "nbytes", "most"),
    [("words", 0, 64), ("words", 7, 64), ("words", 66, 64), ("message", 4098, 4096)],
)
def test_wrong_sizes_are_refused(buffer: str, nbytes: int, most: int) -> None:
    """None, odd, more than the buffer has, more than there is room for outside."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.send(core.array(buffer), nbytes)

    with pytest.raises(
        FirmwareError,
        match=f"a message must have 2 to {most} bytes of {buffer}, whole words, not {nbytes} .*test_spi.py:",
    ):
        run(every_frame(work))


def spoil(octets: bytes, way: str) -> bytes:
    """Break a message."""
    words = np.frombuffer(octets, np.uint16).copy()
    if way == "cut short":
        return octets[:-2]
    if way == "sync word":
        words[0] ^= 1
    elif way == "checksum":
        words[-1] ^= 1
    else:
        words[1] = 99
        framed = words[:-1].tobytes()
        words[-1] = crc_hqx(framed[2:], 0xFFFF)
    return words.tobytes()


@pytest.mark.parametrize("way", ["cut short", "sync word", "checksum", "type of a message"])
def test_what_is_no_message_ends_the_run_with_the_reason(way: str) -> None:
    """The strategy unit is not given garbage."""

    def work(core: Core, frame: Frame) -> Play:
        octets = spoil(encode(results(1)), way)
        core.array("message").octets[: len(octets)] = octets
        yield from core.send(core.array("message"), len(octets))

    with pytest.raises(MessageError, match=way):
        run(every_frame(work))


FIRMWARE = """\
from bfsim.api import Buffer, Firmware, u8, u16

def talk(core):
    while (yield from core.next_frame()) is not None:
        core.array("message").array[:4] = 0xB5F1, 1, 0, 100
        yield from core.send(core.array("message"), 8)

def watch(core):
    while (yield from core.next_frame()) is not None:
        pass

def buffers(size):
    def camera(bank):
        return Buffer("camera", u8, 2 * size.width_px, bank, rows=2 * size.height_px)
    return {
        "A": (camera("sdram_bank0"), Buffer("message", u16, 16, "L1_data_a")),
        "B": (camera("sdram_bank1"),),
    }

fw = Firmware(mains={"A": talk, "B": watch}, buffers=buffers, camera="camera", rows=())
"""


def test_the_command_line_ends_with_2(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One paragraph: what the message says of itself, and what came."""
    (tmp_path / "fw_cut_short.py").write_text(FIRMWARE)
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(
        main, ["run", "--firmware", "fw_cut_short:fw", "--frames", "1"], catch_exceptions=False
    )
    assert result.exit_code == 2
    assert " ".join(result.stderr.split()) == (
        "bfsim: error: a message with a payload of 100 bytes must have 110 bytes, but is cut short after 8"
    )
