"""The strategy unit as a device on the SPI: it records what the vision sensor reports, and follows a script."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType

from bfsim.api import Script, SpiDevice, SpiMessage
from tinyphoon.strategy.modes import INDOOR_FIELD, Mode
from tinyphoon.strategy_unit.entries import entries_of
from tinyphoon.strategy_unit.messages import Message, MessageType, decode


@dataclass(frozen=True, slots=True)
class Received:
    """A message, and when its last word arrived."""

    time_ns: int
    message: Message


class StrategyUnit(SpiDevice):
    """Takes messages whole and at once, and requests to send as soon as an entry of its script is due."""

    def __init__(self, script: Script = MappingProxyType({}), mode: Mode = INDOOR_FIELD) -> None:
        """`script`, `mode`: see `entries_of`, which raises FirmwareError for mistakes in the script."""
        self._to_send = deque(entries_of(script, mode))
        self._reported = 0
        self.received: list[Received] = []
        """Every message so far, in the order of arrival."""

    def receive(self, octets: bytes, now_ns: int) -> str:
        """Record a message, and return its type; raise MessageError if it is invalid."""
        message = decode(octets)
        self.received.append(Received(now_ns, message))
        self._reported += message.type is MessageType.RESULTS
        return message.type.name

    def requests(self, now_ns: int) -> bool:
        """Whether the next entry of the script is due, by the number of reported frames."""
        return bool(self._to_send) and self._to_send[0].after_frames <= self._reported

    def send(self, now_ns: int) -> SpiMessage:
        """Return the message of the next entry."""
        return self._to_send.popleft().message

    def finish(self) -> Sequence[str]:
        """Return remarks on entries that came too late, or that the firmware did not request."""
        if not self._to_send:
            return ()
        count = len(self._to_send)
        entries = "1 entry of the script was" if count == 1 else f"{count:,} entries of the script were"
        first = self._to_send[0].after_frames
        return (
            f"{entries} not taken, the first with after_frames = {first}: {self._reported:,} frames were reported",
        )
