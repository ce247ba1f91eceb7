"""The other end of the SPI: a strategy unit that records what the vision sensor reports and follows a script."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from bfsim.machine.spi.protocol import Message, MessageType, decode, encode


@dataclass(frozen=True, slots=True, kw_only=True)
class ScriptedMessage:
    """What to send once the vision sensor has reported `after_frames` frames; 0: before the first one."""

    after_frames: int
    type: MessageType
    payload: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class ScriptedBytes:
    """The same for bytes that go over the wire as they are, whether they are a message or not."""

    after_frames: int
    octets: bytes


Script = Sequence[ScriptedMessage | ScriptedBytes]


@dataclass(frozen=True, slots=True)
class Received:
    """A message, and the tick at which its last word was in."""

    ticks: int
    message: Message


class StrategyUnit:
    """Takes messages whole and at once; what they do on the way there is the wire's and the bus's."""

    def __init__(self, script: Script = ()) -> None:
        """`script`: in any order; messages due at the same time are sent in the order given."""
        self._to_send = deque(sorted(script, key=lambda each: each.after_frames))
        self._sent = 0
        self.received: list[Received] = []
        """Every message so far, in the order of arrival."""

    def receive(self, octets: bytes, now: int) -> Message:
        """Record the message that is in at tick `now`; raise MessageError if `octets` are none."""
        message = decode(octets)
        self.received.append(Received(now, message))
        return message

    def due(self, frames: int) -> list[bytes]:
        """Return the messages to send now that `frames` frames are reported, encoded; each is returned once."""
        due: list[bytes] = []
        while self._to_send and self._to_send[0].after_frames <= frames:
            each = self._to_send.popleft()
            if isinstance(each, ScriptedBytes):
                due.append(each.octets)
            else:
                due.append(encode(Message(each.type, self._sent % 0x10000, each.payload)))
                self._sent += 1
        return due
