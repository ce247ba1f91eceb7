"""SPI: how long messages take, what arrives at the other end, what comes in, and what is refused."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import ceil
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import Buffer, Core, Frame, SpiDevice, SpiMessage, u16
from bfsim.chip.boards import CM_BF561, CM_BF561_RATINGS
from bfsim.chip.spec import BoardSpec
from bfsim.errors import FirmwareError
from bfsim.trace import BoardRecord, MessageRecord, StallReason
from tests.machine.kernels import spin
from tests.machine.made_boards import CHIP, assert_accounted, cclk_now, in_work, made_board, put
from tests.machine.rig import Play, cycles_of, every_frame, noise, stage_of

ROOM_BYTES = 8192
MORE = (
    Buffer("message", u16, ROOM_BYTES // 2, "L1_data_a"),
    Buffer("far", u16, ROOM_BYTES // 2, "sdram_bank2"),
)
WRITES = 5  # SPI_CTL, and START_ADDR, X_COUNT, X_MODIFY and CONFIG
SETUP_CCLK = WRITES * CHIP.events.mmr_write_cclk
GAP_SCK = 1
WORDS = st.integers(1, 150).flatmap(lambda count: st.binary(min_size=2 * count, max_size=2 * count))
REPORT = b"a report of what was seen"[:24]


class Talker(SpiDevice):
    """Records what it receives, and has a message to send after so many of them."""

    def __init__(self, *to_send: tuple[int, SpiMessage]) -> None:
        self.to_send = deque(to_send)
        self.received: list[bytes] = []

    def receive(self, octets: bytes, now_ns: int) -> str:
        self.received.append(octets)
        return "report"

    def requests(self, now_ns: int) -> bool:
        return bool(self.to_send) and self.to_send[0][0] <= len(self.received)

    def send(self, now_ns: int) -> SpiMessage:
        return self.to_send.popleft()[1]

    def finish(self) -> Sequence[str]:
        return [f"{message.type} was not taken" for _, message in self.to_send]


def wire_cclk(nbytes: int, spec: BoardSpec = CM_BF561) -> Fraction:
    """Cycles of so many bytes on the wire: 16 bits and the gap behind each word, at the rate that BAUD makes."""
    clocks = spec.clocks
    baud = max(2, ceil(clocks.sclk_hz / spec.spi_clk_hz / 2))
    sck_cclk = clocks.cclk_hz / (clocks.sclk_hz / (2 * baud))
    return nbytes // 2 * (16 + GAP_SCK) * sck_cclk


def run(
    main_a: Any,
    main_b: Any = None,
    *,
    frames: int = 1,
    script: Sequence[tuple[int, SpiMessage]] = (),
    **made: Any,
) -> tuple[BoardRecord, list[bytes]]:
    """Run firmware; return the outcome and what the device received. `script`: what it sends, after how many messages."""
    mains = (main_a,) if main_b is None else (main_a, main_b)
    device = Talker(*script)
    board = made_board(*mains, more=MORE, devices={"SPI": device}, **made)
    outcome = board.run(noise(frames, board.size))
    assert_accounted(outcome)
    return outcome, device.received


@pytest.mark.parametrize("spi_mhz", [1, 10, 20, 50])
@pytest.mark.parametrize("board", [CM_BF561, CM_BF561_RATINGS], ids=lambda each: each.name)
@pytest.mark.parametrize("nbytes", [2, 10, 18, 110])
def test_words_and_gaps_make_the_time_on_the_wire(nbytes: int, board: BoardSpec, spi_mhz: int) -> None:
    """From the SCLK edge behind the last register write to the last word's gap; SCK is at most a quarter of SCLK."""
    spec = replace(board, spi_clk_hz=Fraction(spi_mhz * 1_000_000))
    written = []

    def work(core: Core, frame: Frame) -> Play:
        yield from core.send(core.array("message"), put(core, bytes(nbytes)))
        written.append(core.now_ticks)

    outcome, received = run(every_frame(work), spec=spec)
    assert received == [bytes(nbytes)]
    clocks = spec.clocks
    edge_ticks = ceil(Fraction(written[0], clocks.sclk_ticks)) * clocks.sclk_ticks
    end_cclk = ceil(Fraction(edge_ticks, clocks.cclk_ticks) + wire_cclk(nbytes, spec))
    assert outcome.messages == (
        MessageRecord(
            over="SPI",
            direction="out",
            type="report",
            nbytes=nbytes,
            begin_cclk=written[0] // clocks.cclk_ticks,
            end_cclk=end_cclk,
        ),
    )


@settings(max_examples=30)
@given(st.lists(WORDS, min_size=1, max_size=4), st.sampled_from(["message", "far"]))
def test_every_message_arrives_as_it_was_sent(sent: list[bytes], buffer: str) -> None:
    """Of any content and size, from L1 and from SDRAM, in order."""

    def work(core: Core, frame: Frame) -> Play:
        for each in sent:
            if (sending := core._parts.messages._peripherals["SPI"].sending) is not None:
                yield sending  # the buffer is in use
            yield from core.send(core.array(buffer), put(core, each, buffer))

    _, received = run(every_frame(work))
    assert received == sent


def test_the_core_goes_on_and_the_next_message_waits() -> None:
    """Sending costs the register writes; a second message in a row waits until the first is out."""

    def work(core: Core, frame: Frame) -> Play:
        nbytes = put(core, REPORT)
        yield from core.send(core.array("message"), nbytes)
        yield core.run(spin, 10)
        yield from core.send(core.array("message"), nbytes)

    outcome, received = run(in_work(work))
    assert len(received) == 2
    waited = wire_cclk(len(REPORT)) - cycles_of(spin, 10)
    assert stage_of(outcome.frames[0], "Work").stall_cclk == {
        StallReason.DMA_SETUP: 2 * SETUP_CCLK,
        StallReason.RING_FULL: waited,
    }
    first, second = outcome.messages
    assert second.begin_cclk == first.end_cclk + SETUP_CCLK


def test_a_frame_later_nothing_waits() -> None:
    """A message a frame: the wire is long free."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.send(core.array("message"), put(core, bytes([frame.index, 0])))

    outcome, received = run(in_work(work), frames=3)
    assert [each[0] for each in received] == [0, 1, 2]
    for frame in outcome.frames:
        assert stage_of(frame, "Work").stall_cclk == {StallReason.DMA_SETUP: SETUP_CCLK}


def test_both_cores_may_send_at_the_same_time() -> None:
    """One wire: the messages go out one after the other, and both are whole."""

    def sending(octets: bytes) -> Any:
        def work(core: Core, frame: Frame) -> Play:
            row = core.array("message" if core.name == "A" else "words")
            row.octets[: len(octets)] = octets
            yield from core.send(row, len(octets))
            yield from core.send(row, len(octets))

        return every_frame(work)

    one, other = b"one report", b"the other "
    outcome, received = run(sending(one), sending(other))
    assert sorted(received) == [one, one, other, other]
    times = [(each.begin_cclk, each.end_cclk) for each in outcome.messages]
    assert all(end <= begin for (_, end), (begin, _) in itertools.pairwise(times))
    for begin, end in times:
        assert end - begin == wire_cclk(len(one))


def test_every_core_with_a_handler_is_interrupted() -> None:
    """When the DMA of the SPI is done, each core's own interrupt controller sees it."""
    handled = []

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("SPI_DMA", lambda core: handled.append(core.name))
        if core.name == "A":
            yield from core.send(core.array("message"), put(core, REPORT))
        yield from core.idle()

    outcome, _ = run(every_frame(work), every_frame(work))
    assert sorted(handled) == ["A", "B"]
    assert outcome.interrupts == {"A SPI_DMA": 1, "B SPI_DMA": 1}


# ---- messages in

FIRST, SECOND, THIRD = (SpiMessage(each, each.encode()) for each in ("first!", "second", "another one!"))
SCRIPT = ((0, FIRST), (2, SECOND), (2, THIRD))


def test_what_the_device_has_to_say_comes_in_when_it_asks_to() -> None:
    """Before that nothing; each message once, in order."""
    got: list[tuple[int, bytes]] = []

    def work(core: Core, frame: Frame) -> Play:
        row = core.array("message")
        while nbytes := (yield from core.receive(row)):
            got.append((frame.index, row.octets[:nbytes].tobytes()))
        yield from core.send(row, put(core, REPORT))

    outcome, _ = run(every_frame(work), frames=4, script=SCRIPT)
    assert got == [(0, b"first!"), (2, b"second"), (2, b"another one!")]
    incoming = [each for each in outcome.messages if each.direction == "in"]
    assert [each.type for each in incoming] == ["first!", "second", "another one!"]
    assert outcome.device_notes == {}


@pytest.mark.parametrize(
    ("frames", "left"), [(1, ["second", "another one!"]), (2, ["second", "another one!"]), (3, [])]
)
def test_the_device_has_the_last_word(frames: int, left: list[str]) -> None:
    """What it tells at the end of a run is in the records: here what was due when nobody asked any more."""

    def work(core: Core, frame: Frame) -> Play:
        row = core.array("message")
        while (yield from core.receive(row)):
            pass
        yield from core.send(row, put(core, REPORT))

    outcome, _ = run(every_frame(work), frames=frames, script=SCRIPT)
    said = tuple(f"{each} was not taken" for each in left)
    assert outcome.device_notes == ({"SPI": said} if said else {})


def test_a_message_in_is_waited_for_and_an_empty_wire_is_not() -> None:
    """Register writes and the time on the wire; when there is nothing, nothing is paid."""
    times = []

    def work(core: Core, frame: Frame) -> Play:
        row = core.array("message")
        times.append(cclk_now(core))
        assert (yield from core.receive(row)) == len(FIRST.octets)
        times.append(cclk_now(core))
        assert (yield from core.receive(row)) == 0
        times.append(cclk_now(core))

    outcome, _ = run(in_work(work), script=SCRIPT[:1])
    before, got, nothing = times
    wire = wire_cclk(len(FIRST.octets))
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
    assert sorted(got) == [0, len(FIRST.octets)]


def test_what_has_no_room_is_lost() -> None:
    """The DMA takes as many words as the buffer has; the rest goes by, and the next message is whole."""
    got = []

    def work(core: Core, frame: Frame) -> Play:
        for row in (core.rows("short_ring")[0], core.array("message")):
            nbytes = yield from core.receive(row)
            got.append(row.octets[:nbytes].tobytes())

    long = SpiMessage("long", bytes(range(100)))
    outcome, _ = run(every_frame(work), script=[(0, long), (0, FIRST)])
    assert got == [bytes(range(16)), FIRST.octets]
    assert [(each.type, each.nbytes) for each in outcome.messages] == [
        ("long (cut short)", 16),
        ("first!", 6),
    ]


def test_without_a_device_nobody_listens_and_nobody_speaks() -> None:
    """The wire is there all the same: a message takes its time."""
    got = []

    def work(core: Core, frame: Frame) -> Play:
        got.append((yield from core.receive(core.array("message"))))
        yield from core.send(core.array("message"), put(core, REPORT))

    outcome = made_board(every_frame(work), more=MORE).run(noise(1))
    assert got == [0]
    assert [(each.direction, each.type, each.nbytes) for each in outcome.messages] == [
        ("out", "words", len(REPORT))
    ]
    assert outcome.device_notes == {}


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


@pytest.mark.parametrize(
    "call", [lambda core, row: core.send(row, 2, "CAN"), lambda core, row: core.receive(row, "CAN")]
)
def test_peripherals_are_known_by_name(call: Any) -> None:
    """The message names those that the chip has."""

    def work(core: Core, frame: Frame) -> Play:
        yield from call(core, core.array("words"))

    with pytest.raises(FirmwareError, match="messages must go over SPI.*, not 'CAN' .*test_spi.py:"):
        run(every_frame(work))
