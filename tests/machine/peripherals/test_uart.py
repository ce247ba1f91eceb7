"""UART: how long bytes take each way, by whose clock, what arrives, what the bus sees of it, and what is refused."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from fractions import Fraction
from math import ceil
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import Buffer, Core, Firmware, Frame, UartDevice, UartMessage, u8
from bfsim.errors import FirmwareError
from bfsim.machine.board import Fidelity
from bfsim.machine.bus import state as w
from bfsim.machine.peripherals.table import devices_of
from bfsim.machine.peripherals.uart import Uart
from bfsim.machine.peripherals.wire import Surroundings
from bfsim.trace import BoardRecord, StallReason
from tests.machine.bench import Bench
from tests.machine.kernels import spin
from tests.machine.made_boards import CHIP, CLOCKS, assert_accounted, cclk_now, in_work, made_board, put
from tests.machine.rig import Play, every_frame, noise, stage_of

MORE = (
    Buffer("message", u8, 5000, "L1_data_a"),
    Buffer("far", u8, 5000, "sdram_bank2"),
    Buffer("short", u8, 5, "L1_data_a"),
)
SETUP_CCLK = 5 * CHIP.events.mmr_write_cclk  # UART_IER, and START_ADDR, X_COUNT, X_MODIFY and CONFIG
BITS = 10
RATES = [(9600, 781), (115_200, 65), (921_600, 8), (7_500_000, 1)]
"""Rates of the other end, and the divisors for them at 120 MHz."""


class Talker(UartDevice):
    """Records what it receives and when, and has messages to send, the first at once, the others behind each other."""

    def __init__(self, *to_send: UartMessage, baud: Fraction | int = 115_200) -> None:
        self.baud = baud
        self.to_send = deque(to_send)
        self.received: list[tuple[bytes, int]] = []

    def receive(self, octets: bytes, now_ns: int) -> str:
        self.received.append((octets, now_ns))
        return "line"

    def requests(self, now_ns: int) -> bool:
        return bool(self.to_send)

    def send(self, now_ns: int) -> UartMessage:
        return self.to_send.popleft()

    def finish(self) -> Sequence[str]:
        return [f"{each.type} was not taken" for each in self.to_send]


def out_ticks(nbytes: int, divisor: int) -> int:
    """Ticks of so many bytes on their way out: whole SCLK cycles, 16 a bit for each of the divisor."""
    return nbytes * BITS * 16 * divisor * CLOCKS.sclk_ticks


def in_ticks(nbytes: int, baud: Fraction | int) -> Fraction:
    """Ticks of so many bytes on their way in, by the clock of the other end."""
    return nbytes * BITS * CLOCKS.tick_hz / baud


def edge(ticks: Fraction | int) -> int:
    """Return the first SCLK edge from then on."""
    return ceil(Fraction(ticks) / CLOCKS.sclk_ticks) * CLOCKS.sclk_ticks


def run(main_a: Any, *mains: Any, device: UartDevice, frames: int = 1, **made: Any) -> BoardRecord:
    """Run firmware with a device on the UART."""
    board = made_board(main_a, *mains, more=MORE, devices={"UART": device}, **made)
    outcome = board.run(noise(frames, board.size))
    assert_accounted(outcome)
    return outcome


# ---- times, from both sides


class OnBench:
    """The UART of a bench, alone with its device."""

    def __init__(self, device: UartDevice) -> None:
        self.bench = Bench(outside_nbytes=2 * 4096)
        self.interrupts: list[tuple[str, int]] = []
        around = Surroundings(
            env=self.bench.env,
            board=self.bench.spec,
            bus=self.bench.bus,
            memories=self.bench.memories,
            interrupt=lambda source: self.interrupts.append((source, self.bench.env.tick)),
        )
        self.uart = Uart(around, device, self.bench.memories.outside)
        self.row = self.bench.row(0xFF800000, 256)

    def check_end(self, tick: int) -> None:
        """The message is not whole before `tick`, and is there at it."""
        self.bench.env.run(until=tick)  # all that is before it
        assert not self.uart.records
        self.bench.env.run(until=tick + 1)
        assert len(self.uart.records) == 1


@pytest.mark.parametrize(("baud", "divisor"), RATES)
@pytest.mark.parametrize("nbytes", [1, 2, 3, 100])
def test_bytes_out_take_the_time_of_the_divisor(baud: int, divisor: int, nbytes: int) -> None:
    """A start bit, eight of data and a stop bit each, one byte behind the other; then the device has them, and the interrupt comes."""
    device = Talker(baud=baud)
    on = OnBench(device)
    sent = on.row.octets[:nbytes].tobytes()
    on.uart.send(on.row, nbytes)
    end = out_ticks(nbytes, divisor)
    on.check_end(end)
    assert device.received == [(sent, CLOCKS.ns_of_ticks(end))]
    assert on.interrupts == [("UART_TX_DMA", end)]


@pytest.mark.parametrize("baud", [9600, 115_200, 921_600, 7_500_000, Fraction(7_600_000)])
@pytest.mark.parametrize("nbytes", [1, 2, 3, 100])
def test_bytes_in_take_the_time_of_the_other_end(baud: Fraction | int, nbytes: int) -> None:
    """Whatever the divisor; DMA stores each at the SCLK edge behind its stop bit, and raises its interrupt behind the last."""
    octets = bytes(range(nbytes))
    on = OnBench(Talker(UartMessage("line", octets), baud=baud))
    on.uart.receive(on.row)
    end = edge(in_ticks(nbytes, baud))
    on.check_end(end)
    assert on.row.octets[:nbytes].tobytes() == octets
    assert on.interrupts == [("UART_RX_DMA", end)]


@pytest.mark.parametrize(("baud", "divisor"), RATES)
def test_a_core_waits_for_what_comes_in_and_not_for_what_goes_out(baud: int, divisor: int) -> None:
    """Sending costs the register writes; receiving those and the wire, to the first CCLK behind."""
    times: list[int] = []

    def work(core: Core, frame: Frame) -> Play:
        times.append(core.now_ticks)
        yield from core.send(core.array("message"), put(core, b"a line"), over="UART")
        times.append(core.now_ticks)
        times.append((yield from core.receive(core.array("far"), over="UART")))
        times.append(core.now_ticks)
        assert (yield from core.receive(core.array("far"), over="UART")) == 0
        times.append(core.now_ticks)

    outcome = run(in_work(work), device=Talker(UartMessage("answer", b"yes"), baud=baud))
    before, sent, nbytes, got, nothing = times
    setup = SETUP_CCLK * CLOCKS.cclk_ticks
    assert (sent - before, nbytes, nothing) == (setup, 3, got)
    begin = sent + setup
    out, into = sorted(outcome.messages, key=lambda each: each.direction, reverse=True)
    assert out.end_cclk == ceil(Fraction(edge(sent) + out_ticks(6, divisor), CLOCKS.cclk_ticks))
    # the last byte's word of SDRAM is through some cycles behind the edge at which it asks for the bus
    stored = got - edge(begin + in_ticks(3, baud))
    assert 0 < stored <= 10 * CLOCKS.sclk_ticks
    assert (into.begin_cclk, into.end_cclk) == (begin // CLOCKS.cclk_ticks, got // CLOCKS.cclk_ticks)
    assert [each.over for each in outcome.messages] == ["UART", "UART"]
    assert stage_of(outcome.frames[0], "Work").stall_cclk == {
        StallReason.DMA_SETUP: 2 * SETUP_CCLK,
        StallReason.RING_EMPTY: (got - begin) // CLOCKS.cclk_ticks,
    }


# ---- what arrives


@settings(max_examples=30)
@given(
    st.lists(st.binary(min_size=1, max_size=200), min_size=1, max_size=4),
    st.lists(st.binary(min_size=1, max_size=200), min_size=1, max_size=4),
    st.sampled_from(["message", "far"]),
)
def test_every_byte_arrives_as_it_was_sent(out: list[bytes], into: list[bytes], buffer: str) -> None:
    """Of any number, odd ones too, both ways, to L1 and to SDRAM, in order."""
    got = []

    def work(core: Core, frame: Frame) -> Play:
        for each in into:
            row = core.array(buffer)
            nbytes = yield from core.receive(row, over="UART")
            got.append(row.octets[:nbytes].tobytes())
            assert len(each) == nbytes
        for each in out:
            while (sending := core._parts.messages._peripherals["UART"].sending) is not None:
                yield sending  # the buffer is in use
            yield from core.send(core.array(buffer), put(core, each, buffer), over="UART")

    device = Talker(*(UartMessage("line", each) for each in into), baud=7_500_000)
    run(every_frame(work), device=device)
    assert got == into
    assert [octets for octets, _ in device.received] == out


def test_both_ways_go_at_the_same_time_and_beside_the_spi() -> None:
    """Two wires, unlike the SPI's; each has its own time, whoever else is at work."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.send(core.array("message"), put(core, bytes(200)), over="UART")
        yield from core.send(core.array("far"), 200)
        yield from core.receive(core.array("short"), over="UART")

    outcome = run(every_frame(work), device=Talker(UartMessage("five!", b"five!")))
    by = {(each.over, each.direction): each for each in outcome.messages}
    long, beside, short = by["UART", "out"], by["SPI", "out"], by["UART", "in"]
    assert long.begin_cclk < beside.begin_cclk < short.begin_cclk
    assert short.end_cclk < long.end_cclk
    assert (
        abs((long.end_cclk - long.begin_cclk) * CLOCKS.cclk_ticks - out_ticks(200, 65))
        <= 2 * CLOCKS.sclk_ticks
    )
    assert (
        abs((short.end_cclk - short.begin_cclk) * CLOCKS.cclk_ticks - in_ticks(5, 115_200))
        <= 2 * CLOCKS.sclk_ticks
    )


def test_a_second_message_out_waits_for_the_first() -> None:
    """As over the SPI: that is the stall "ring full"."""

    def work(core: Core, frame: Frame) -> Play:
        for _ in range(2):
            yield from core.send(core.array("message"), put(core, bytes(10)), over="UART")

    outcome = run(in_work(work), device=Talker())
    first, second = outcome.messages
    assert second.begin_cclk == first.end_cclk + SETUP_CCLK
    assert stage_of(outcome.frames[0], "Work").stall_cclk == {
        StallReason.DMA_SETUP: 2 * SETUP_CCLK,
        StallReason.RING_FULL: first.end_cclk - first.begin_cclk,
    }


def test_what_has_no_room_is_lost_and_what_nobody_took_is_told() -> None:
    """DMA takes as many bytes as the buffer has."""
    got = []

    def work(core: Core, frame: Frame) -> Play:
        row = core.array("short")
        nbytes = yield from core.receive(row, over="UART")
        got.append(row.octets[:nbytes].tobytes())

    outcome = run(
        every_frame(work), device=Talker(UartMessage("long", b"too long"), UartMessage("next", b"x"))
    )
    assert got == [b"too l"]
    assert [each.type for each in outcome.messages] == ["long (cut short)"]
    assert outcome.device_notes == {"UART": ("next was not taken",)}


def test_each_direction_has_an_interrupt_of_its_own() -> None:
    """A core is told of what is out and of what is in, in the order of their ends."""
    handled: list[tuple[str, int]] = []

    def work(core: Core, frame: Frame) -> Play:
        for source in ("UART_RX_DMA", "UART_TX_DMA"):
            core.on_interrupt(source, lambda core, source=source: handled.append((source, cclk_now(core))))
        yield from core.send(core.array("message"), put(core, bytes(20)), over="UART")
        yield from core.receive(core.array("short"), over="UART")
        yield from core.idle()

    outcome = run(every_frame(work), device=Talker(UartMessage("one", b"x")))
    assert [source for source, _ in handled] == ["UART_RX_DMA", "UART_TX_DMA"]
    assert outcome.interrupts == {"A UART_RX_DMA": 1, "A UART_TX_DMA": 1}


# ---- the bus


def work_on_bus(core: Core, frame: Frame) -> Play:
    """Send from SDRAM and receive into it."""
    yield from core.send(core.array("far"), put(core, bytes(range(200)), "far"), over="UART")
    yield from core.receive(core.array("far"), over="UART")
    yield core.run(spin, 1000)


def test_the_bus_sees_every_byte() -> None:
    """Each channel is a master, and what is in L1 needs no bus of memories."""
    outcome = run(every_frame(work_on_bus), device=Talker(UartMessage("line", bytes(50)), baud=7_500_000))
    moved = {each.master: each for each in outcome.traffic if each.master.startswith("UART")}
    assert {name: (each.buffer, each.read_bytes, each.written_bytes) for name, each in moved.items()} == {
        "UART RX": ("far", 0, 50),
        "UART TX": ("far", 200, 0),
    }
    assert (
        sum(moved["UART TX"].__getattribute__(f"page_{each}") for each in ("hits", "misses", "conflicts"))
        == 200
    )


def test_a_full_fifo_loses_bytes_and_counts_them() -> None:
    """When DMA comes too late for them: here it does for all but what the FIFO holds."""
    on = OnBench(Talker(UartMessage("line", bytes(100)), baud=7_500_000))
    far = on.bench.row(0x00000000, 256)
    on.bench.bus.words[w.COMMAND_FREE] = edge(in_ticks(90, 7_500_000))  # the SDRAM answers to nobody before
    on.uart.receive(far)
    on.bench.play()
    lost = on.bench.bus.lost_by(w.UART_RX)
    assert 0 < lost <= 90
    assert on.uart.notes == (f"{lost} words came while the FIFO of the DMA was full, and were lost",)


@pytest.mark.parametrize(("baud", "apart_sclk"), [(115_200, 1), (7_500_000, 0)])
def test_the_detailed_mode_agrees(baud: int, apart_sclk: int) -> None:
    """To the cycle where bits of the other end are whole SCLK cycles; else a byte waits for the next edge in the fast mode alone."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.send(core.array("message"), put(core, bytes(range(100))), over="UART")
        yield from core.receive(core.array("short"), over="UART")

    def ends(fidelity: Fidelity) -> list[tuple[str, int]]:
        device = Talker(UartMessage("five!", b"five!"), baud=baud)
        outcome = run(every_frame(work), device=device, fidelity=fidelity)
        return [(each.direction, each.end_cclk) for each in outcome.messages]

    fast, detailed = ends(Fidelity.FAST), ends(Fidelity.DETAILED)
    assert [direction for direction, _ in fast] == [direction for direction, _ in detailed]
    for (_, one), (_, other) in zip(fast, detailed, strict=True):
        assert 0 <= one - other <= apart_sclk * CLOCKS.sclk_ticks // CLOCKS.cclk_ticks


# ---- what is refused


@pytest.mark.parametrize(
    ("baud", "message"),
    [
        (0, "baud of Talker: a rate over the UART must be within 4.6% .*, not 0.0 baud"),
        (
            10_000_000,
            "baud of Talker: a rate .*, not 10,000,000.0 baud: at SCLK 120 MHz the nearest is 7,500,000.0",
        ),
        (115.2, "baud of Talker must be an int or a Fraction, not 115.2"),
        (True, "baud of Talker must be an int or a Fraction, not True"),
    ],
)
def test_wrong_rates_are_refused(baud: Any, message: str) -> None:
    """Before the first frame."""
    with pytest.raises(FirmwareError, match=message):
        made_board(every_frame(work_on_bus), more=MORE, devices={"UART": Talker(baud=baud)})


@pytest.mark.parametrize("octets", [b"", bytes(4097)])
def test_messages_fit(octets: bytes) -> None:
    """At least one byte, at most what there is room for on the way; odd ones do."""
    with pytest.raises(
        FirmwareError, match=f"over UART must have 1 to 4096 bytes, whole 8-bit words, not {len(octets)}"
    ):
        UartMessage("any", octets)
    assert UartMessage("any", b"odd").octets == b"odd"


def test_a_device_is_one_for_the_uart() -> None:
    """One for the SPI has no rate."""
    program = Firmware(mains={}, buffers=lambda _: {}, camera="camera", rows=(), uart=lambda script: "hi")  # type: ignore[return-value,arg-type]
    with pytest.raises(FirmwareError, match=r"uart must make a bfsim.api.UartDevice, not 'hi'"):
        devices_of(program, {})
