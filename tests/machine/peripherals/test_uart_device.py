"""A device on the UART that firmware brings: what a whole run tells of it, and that a recorded one says the same."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from bfsim.report.results.as_json import as_json
from bfsim.report.what_ran.configuration import configuration_of
from bfsim.run import simulate

FIRMWARE = '''\
from bfsim.api import BudgetRow, Buffer, Firmware, UartDevice, UartMessage, u8


class Receiver(UartDevice):
    """Has a line to say at every hundredth of a second; says it `words` times, and waits for one back."""

    def __init__(self, script):
        self.baud = script.get("baud", 115_200)
        self.left = script.get("lines", 2)
        self.heard = 0

    def receive(self, octets, now_ns):
        self.heard += 1
        return "answer"

    def requests(self, now_ns):
        return self.left > 0

    def send(self, now_ns):
        self.left -= 1
        return UartMessage("fix", b"$GPGGA")

    def finish(self):
        return [f"{self.left} lines were not taken"] if self.left else []


def main(core):
    while (yield from core.next_frame()) is not None:
        if core.name == "A":
            with core.stage("Talk"):
                line = core.array("line")
                nbytes = yield from core.receive(line, over="UART")
                if nbytes:
                    yield from core.send(line, nbytes, over="UART")


def buffers(size):
    return {
        core: [
            Buffer("camera", u8, 2 * size.width_px, f"sdram_bank{number}", rows=2 * size.height_px),
            Buffer("line", u8, 80, "L1_data_a"),
        ]
        for number, core in enumerate("AB")
    }


listening = Firmware(
    mains={"A": main, "B": main}, buffers=buffers, camera="camera", rows=(BudgetRow(stage="Talk"),), uart=Receiver
)
'''


@pytest.fixture
def firmware(tmp_path: Path) -> Iterator[str]:
    """A user's firmware with a device on the UART."""
    (tmp_path / "listening.py").write_text(FIRMWARE)
    yield f"{tmp_path}/listening.py:listening"


def test_firmware_brings_a_device_and_the_run_tells_of_it(firmware: str, tmp_path: Path) -> None:
    """In records, report and JSON; the script reaches it."""
    script = tmp_path / "script.json"
    script.write_text(json.dumps({"lines": 3, "baud": 9600}))
    done = simulate(firmware=firmware, frames=2, script=script)
    assert [(each.over, each.direction, each.type) for each in done.messages] == [
        ("UART", "in", "fix"),
        ("UART", "out", "answer"),
    ] * 2
    told = dict(configuration_of(done))
    assert told["UART messages"].startswith("2 out (12 bytes, at most 6")
    assert "SPI messages" not in told
    plain = as_json(done)
    assert plain["messages"][0]["over"] == "UART"
    assert plain["device_notes"] == {"UART": ["1 lines were not taken"]}
    assert {"kind": "UART device", "text": "1 lines were not taken"} in plain["warnings"]


def test_where_nobody_uses_it_nothing_is_told_of_it() -> None:
    """The built-in firmware talks over the SPI alone."""
    done = simulate(frames=1)
    assert {each.over for each in done.messages} == {"SPI"}
    assert "UART" not in json.dumps(as_json(done))
    assert not any("UART" in name or "UART" in text for name, text in configuration_of(done))


def test_a_recorded_run_sends_and_receives_again(firmware: str, tmp_path: Path) -> None:
    """What went over the UART goes over it again, in its time there; what comes at another time is refused."""
    work = tmp_path / "uart.work"
    done = simulate(firmware=firmware, frames=2, record_work=work)
    again = simulate(firmware=firmware, frames=2, work=work)
    assert (again.messages, again.frames) == (done.messages, done.frames)
    slower = {"clocks.sclk_hz": 100e6, "clocks.cclk_hz": 500e6}
    there = simulate(firmware=firmware, frames=2, settings=slower)
    assert (
        simulate(firmware=firmware, frames=2, work=work, settings=slower).messages
        == there.messages
        != done.messages
    )
