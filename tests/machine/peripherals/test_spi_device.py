"""A device that firmware brings: what it is told and when, its script, and whose mistake is whose."""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from bfsim.api import Buffer, Core, Frame, SpiDevice, SpiMessage, u16
from bfsim.chip.boards import CM_BF561
from bfsim.errors import BfsimError, ConfigError, FirmwareError
from bfsim.run import simulate
from bfsim.running.device_script import read_script
from bfsim.trace import BoardRecord
from tests.machine.kernels import spin
from tests.machine.made_boards import made_board
from tests.machine.rig import Play, every_frame, noise

MESSAGE = Buffer("message", u16, 16, "L1_data_a")
LATE_NS = 5_000


class Echo(SpiDevice):
    """Sends everything back, 5 us after it came."""

    def __init__(self) -> None:
        self.heard_ns: list[int] = []
        self._answers: deque[tuple[int, bytes]] = deque()

    def receive(self, octets: bytes, now_ns: int) -> str:
        self.heard_ns.append(now_ns)
        self._answers.append((now_ns + LATE_NS, octets))
        return "question"

    def requests(self, now_ns: int) -> bool:
        return bool(self._answers) and self._answers[0][0] <= now_ns

    def send(self, now_ns: int) -> SpiMessage:
        return SpiMessage("answer", self._answers.popleft()[1])


def run(work: Any, device: SpiDevice) -> BoardRecord:
    """Play one frame to firmware that talks to a device."""
    return made_board(every_frame(work), more=(MESSAGE,), devices={"SPI": device}).run(noise(1))


def test_an_echo_answers_in_its_own_time() -> None:
    """The device's clock is the board's: the request line is down until the answer is due, to the nanosecond."""
    device, asked = Echo(), []

    def work(core: Core, frame: Frame) -> Play:
        question, answer = core.array("message"), core.array("words")
        question.octets[:6] = b"Hello!"
        yield from core.send(question, 6)
        while not (nbytes := (yield from core.receive(answer))):
            asked.append(CM_BF561.clocks.ns_of_ticks(core.now_ticks))
            yield core.run(spin, 10)
        assert answer.octets[:nbytes].tobytes() == b"Hello!"

    outcome = run(work, device)
    question, answer = outcome.messages
    assert (question.direction, question.type, question.nbytes) == ("out", "question", 6)
    assert (answer.direction, answer.type, answer.nbytes) == ("in", "answer", 6)
    (heard_ns,) = device.heard_ns
    assert heard_ns == pytest.approx(question.end_cclk / 0.6, abs=2)
    assert max(asked) < heard_ns + LATE_NS <= answer.begin_cclk / 0.6


@pytest.mark.parametrize("octets", [b"", b"odd", bytes(4098)])
def test_messages_are_whole_words_that_fit(octets: bytes) -> None:
    """At least one word, at most what there is room for on the way."""
    with pytest.raises(
        FirmwareError, match=f"must have 2 to 4096 bytes, whole 16-bit words, not {len(octets)}"
    ):
        SpiMessage("any", octets)
    assert SpiMessage("largest", bytes(4096)).octets == bytes(4096)


def test_messages_have_a_name_and_bytes() -> None:
    """Not the other way round."""
    with pytest.raises(FirmwareError, match="SpiMessage must have a str and bytes, not bytes and str"):
        SpiMessage(b"any", "words")  # type: ignore[arg-type]


def device_with(**methods: Any) -> SpiDevice:
    """A device that does one thing in its own way."""
    return type("Odd", (SpiDevice,), methods)()


def failing(*_: object) -> Any:
    """What a device does by mistake."""
    return {}["no such key"]


@pytest.mark.parametrize(
    ("device", "message"),
    [
        (
            device_with(finish=lambda *_: "a note"),
            "finish of the device .* must return a list of str, not 'a note'",
        ),
        (
            device_with(receive=lambda *_: sys.exit(3)),
            "the device on the SPI failed with SystemExit: 3 .*test_spi_dev",
        ),
        (
            device_with(receive=lambda *_: None),
            "receive of the device on the SPI must return a str, not None",
        ),
        (
            device_with(requests=lambda *_: True, send=lambda *_: b"xx"),
            "send of the device on the SPI must return SpiMessage, not b'xx'",
        ),
        (
            device_with(requests=lambda *_: True),
            "failed with NotImplementedError: a device that requests must send",
        ),
        (
            device_with(receive=failing),
            "the device on the SPI failed with KeyError: 'no such key' .*test_spi_device.py:",
        ),
        (
            device_with(requests=failing),
            "the device on the SPI failed with KeyError: 'no such key' .*test_spi_device.py:",
        ),
        (
            device_with(finish=failing),
            "the device on the SPI failed with KeyError: 'no such key' .*test_spi_device.py:",
        ),
    ],
)
def test_mistakes_of_a_device_are_told_as_such(device: SpiDevice, message: str) -> None:
    """With the line in the device."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.send(core.array("message"), 2)
        while (sending := core._parts.messages._peripherals["SPI"].sending) is not None:
            yield sending
        yield from core.receive(core.array("message"))

    with pytest.raises(FirmwareError, match=message):
        run(work, device)


def test_a_device_may_end_the_run() -> None:
    """What it says is what the user reads."""

    def refuse(*_: object) -> str:
        raise FirmwareError("a question must end in a question mark")

    def work(core: Core, frame: Frame) -> Play:
        yield from core.send(core.array("message"), 2)

    with pytest.raises(FirmwareError, match="^a question must end in a question mark$"):
        run(work, device_with(receive=refuse))


FIRMWARE = """\
from bfsim.api import Buffer, Firmware, FirmwareError, SpiDevice, SpiMessage, u8, u16

class Greeter(SpiDevice):
    def __init__(self, script):
        self.word = script.get("greeting", "hi")
        if len(self.word) % 2:
            raise FirmwareError(f"greeting must have an even number of letters, not {len(self.word)}")
        self.greeted = False

    def requests(self, now_ns):
        return not self.greeted

    def send(self, now_ns):
        self.greeted = True
        return SpiMessage("greeting", self.word.encode())

def listen(core):
    while (yield from core.next_frame()) is not None:
        nbytes = yield from core.receive(core.array("message"))
        core.publish(letters=nbytes)

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

what = dict(mains={"A": listen, "B": watch}, buffers=buffers, camera="camera", rows=())
greeted = Firmware(**what, spi=Greeter)
alone = Firmware(**what)
odd = Firmware(**what, spi=lambda script: "hi")
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A user's folder, and in it firmware with a device."""
    (tmp_path / "greetings.py").write_text(FIRMWARE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", sys.path[:])
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    yield tmp_path
    sys.modules.pop("greetings", None)


def letters(script: Path | None = None) -> list[int]:
    """Run two frames, and return how many letters came in each."""
    record = simulate(firmware="greetings:greeted", frames=2, script=script)
    return [each.results["letters_A"] for each in record.frames]


def test_firmware_brings_a_device_and_the_user_its_script(folder: Path) -> None:
    """Without a script, the device does what it does by itself; in each run it is a new one."""
    assert letters() == [2, 0]
    assert letters(written(folder, "script.toml", 'greeting = "hello there!"')) == [12, 0]


@pytest.mark.parametrize(
    ("name", "script", "message"),
    [
        ("greeted", 'greeting = "hey"', "script.toml: greeting must have an even number of letters, not 3"),
        (
            "greeted",
            "greeting = 3",
            "script.toml: the device on the SPI failed with TypeError: object of type 'int' has",
        ),
        (
            "alone",
            "",
            "--script must go with firmware that has a device to tell, and greetings:alone has none",
        ),
        ("odd", "", "spi must make a bfsim.api.SpiDevice, not 'hi'"),
    ],
)
def test_what_is_wrong_with_a_script_or_a_device_is_told(
    folder: Path, name: str, script: str, message: str
) -> None:
    """Before the first frame."""
    with pytest.raises(BfsimError, match=message):
        simulate(firmware=f"greetings:{name}", script=written(folder, "script.toml", script))


def written(folder: Path, name: str, text: str) -> Path:
    """Write a script and return where it is."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_scripts_are_json_or_toml(tmp_path: Path) -> None:
    """The same from both, also where an editor has put its mark before the text; the digest is that of the file."""
    one, first = read_script(written(tmp_path, "script.json", '{"send": [{"after": 3}]}'))
    other, second = read_script(written(tmp_path, "script.toml", "[[send]]\nafter = 3\n"))
    assert one == other == {"send": [{"after": 3}]}
    assert first != second == read_script(written(tmp_path, "copy.toml", "[[send]]\nafter = 3\n"))[1]
    for name, text in (("marked.json", '{"send": [{"after": 3}]}'), ("marked.toml", "[[send]]\nafter = 3\n")):
        assert read_script(written(tmp_path, name, f"\N{BYTE ORDER MARK}{text}"))[0] == one


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("script.yaml", "", "script.yaml must end in .json or .toml$"),
        (
            "script.json",
            '{"send":\n x}',
            r"script.json must be JSON: Expecting value: line 2 column 2 \(char 10\)$",
        ),
        (
            "script.toml",
            "[[send]]\nx =\n",
            r"script.toml must be TOML: Invalid value \(at line 2, column 4\)$",
        ),
        ("nan.json", '{"send": [{"after": NaN}]}', "nan.json must be JSON: NaN is no number of JSON$"),
        ("list.json", "[]", "list.json must have keys with values at its top, not be a list$"),
        ("deep.json", 500_000 * "[" + 500_000 * "]", "deep.json must not be nested so deep$"),
        ("deep.toml", "send = " + 50_000 * "[" + 50_000 * "]", "deep.toml must not be nested so deep$"),
    ],
)
def test_files_that_are_no_scripts(tmp_path: Path, name: str, text: str, message: str) -> None:
    """By their name or by their contents, with the line."""
    with pytest.raises(ConfigError, match=message):
        read_script(written(tmp_path, name, text))


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    """Not there, and no text."""
    with pytest.raises(ConfigError, match="must be a readable file: No such file"):
        read_script(tmp_path / "none.toml")
    (tmp_path / "latin.toml").write_bytes(b"name = '\xe4'")
    with pytest.raises(ConfigError, match="latin.toml must be TOML: 'utf-8' codec"):
        read_script(tmp_path / "latin.toml")
