"""The other end of a peripheral: how firmware provides a device that its board talks to.

A device is a class that says what happens at the far end of a wire, such as that of the SPI:

    class Echo(SpiDevice):
        '''Sends everything back, a millisecond after it came.'''

        def __init__(self):
            self._answers = deque()

        def receive(self, octets, now_ns):
            self._answers.append((now_ns + 1_000_000, octets))
            return "question"

        def requests(self, now_ns):
            return bool(self._answers) and self._answers[0][0] <= now_ns

        def send(self, now_ns):
            _, octets = self._answers.popleft()
            return SpiMessage("answer", octets)

Firmware names a function that makes one for each run, from the script that the user gives with `--script FILE`:

    firmware = Firmware(..., spi=lambda script: Echo())

and talks to it from a main loop:

    yield from core.send(row, nbytes)          # to `receive`, as soon as the last word is out
    nbytes = yield from core.receive(row)      # from `send`, if `requests`; 0 bytes if not

Only the board's side is simulated: registers, DMA, the time of each word on the wire, the interrupt of the DMA. The device
itself costs the board no time. If something of its own takes time, `requests` says so by `now_ns`. Runs must be
reproducible: a device may depend only on its script, on what it received and on `now_ns`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, ClassVar

from bfsim.errors import BfsimError, FirmwareError, is_failure, shown
from bfsim.machine.firmware_lines import failure_of, line_of

LARGEST_MESSAGE_BYTES = 4096
"""Room for a message on its way. [ours]"""

Script = Mapping[str, Any]
"""The content of a JSON or TOML file for a device, as dicts, lists, strings and numbers. Empty without a file."""


@dataclass(frozen=True, slots=True)
class Message:
    """What a device sends in one transfer: its name in the report, and its words as bytes, low byte first."""

    type: str
    octets: bytes

    over: ClassVar[str]
    """Name of the peripheral."""
    word_bytes: ClassVar[int]

    def __post_init__(self) -> None:
        if not isinstance(self.type, str) or not isinstance(self.octets, bytes):
            kinds = f"{type(self.type).__name__} and {type(self.octets).__name__}"
            raise FirmwareError(f"{type(self).__name__} must have a str and bytes, not {kinds}")
        if not 0 < len(self.octets) <= LARGEST_MESSAGE_BYTES or len(self.octets) % self.word_bytes:
            raise FirmwareError(
                f"a message over {self.over} must have {self.word_bytes} to {LARGEST_MESSAGE_BYTES} bytes, "
                f"whole {8 * self.word_bytes}-bit words, not {len(self.octets)}"
            )


class Device:
    """A device at the other end of a peripheral. By default it accepts everything and never sends anything.

    Derive from the peripheral's own device class and override what your device does. One object serves one run. Raise
    FirmwareError to end the run, for instance in `receive` if the device does not understand a message: the user sees the
    error's text.
    """

    def receive(self, octets: bytes, now_ns: int) -> str:
        """Take what the board sent, words as bytes, low byte first. Return its name for the report.

        Called once per transfer, when its last word is in, at `now_ns` ns after the start of the run.
        """
        return "words"

    def requests(self, now_ns: int) -> bool:
        """Whether the request line is asserted at `now_ns`: there is something to send. Called whenever firmware looks."""
        return False

    def send(self, now_ns: int) -> Message:
        """Return the next message: firmware begins to receive it at `now_ns`. Called only if `requests` is true.

        Words without room in the firmware's buffer are lost, as on a wire that no one listens to.
        """
        raise NotImplementedError("a device that requests must send")

    def finish(self) -> Sequence[str]:
        """Return warnings for the user when the run is over, a sentence each, such as about messages never fetched."""
        return ()


MakeDevice = Callable[[Script], Device]
"""The script of the user, empty without one → a new device. Raises a FirmwareError that names the key and what it must be."""


@contextmanager
def device_at_work(peripheral: str) -> Iterator[None]:
    """Turn an error inside the device on a peripheral into a FirmwareError that names the device's line."""
    try:
        yield
    except BfsimError:
        raise
    except BaseException as error:
        if not is_failure(error):
            raise
        what = f"{failure_of(error)}{line_of(error)}"
        raise FirmwareError(f"the device on the {peripheral} failed with {what}") from error


def notes_of(device: Device, peripheral: str) -> tuple[str, ...]:
    """Return the warnings of the device on a peripheral, now that the run is over."""
    with device_at_work(peripheral):
        notes = device.finish()
    if isinstance(notes, str) or not all(isinstance(each, str) for each in notes):
        raise FirmwareError(
            f"finish of the device on the {peripheral} must return a list of str, not {shown(notes)}"
        )
    return tuple(notes)
