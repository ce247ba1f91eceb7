"""Messages as the strategy unit makes and reads them; the format is [ours], as the thesis has none.

A message is 16-bit words: a sync word, the type, a sequence number, the bytes of the payload, the payload (followed by
a zero byte if its size is odd) and a CRC of everything between sync word and CRC. Bytes here are in the order of
memory, where DMA takes the words from: low byte first.
"""

from __future__ import annotations

import binascii
import struct
from dataclasses import dataclass
from enum import IntEnum

from bfsim.api import FirmwareError
from tinyphoon.strategy import framing

LARGEST_PAYLOAD_BYTES = 0xFFFF
_HEADER = struct.Struct("<4H")
_CRC = struct.Struct("<H")


class MessageError(FirmwareError):
    """Raised when bytes from the SPI are not a message, or something cannot be sent as one."""


class MessageType(IntEnum):
    """The subject of a message. RESULTS come from the vision sensor, the others go to it."""

    RESULTS = framing.RESULTS
    MODE = framing.MODE
    MODELS = framing.MODELS


@dataclass(frozen=True, slots=True)
class Message:
    """One message. The sender numbers its messages with `sequence`, 0..65535, then from 0 again."""

    type: MessageType
    sequence: int
    payload: bytes

    def __post_init__(self) -> None:
        if not 0 <= self.sequence <= 0xFFFF:
            raise MessageError(f"the sequence number of a message must be 0..65535, not {self.sequence}")
        if len(self.payload) > LARGEST_PAYLOAD_BYTES:
            raise MessageError(
                f"the payload of a message must be at most {LARGEST_PAYLOAD_BYTES} bytes, not {len(self.payload)}"
            )


def message_nbytes(payload_nbytes: int) -> int:
    """Return the size of a whole message in bytes, always even."""
    return _HEADER.size + payload_nbytes + payload_nbytes % 2 + _CRC.size


def encode(message: Message) -> bytes:
    """Return the bytes of a message."""
    size = len(message.payload)
    framed = (
        _HEADER.pack(framing.SYNC, message.type, message.sequence, size) + message.payload + bytes(size % 2)
    )
    return framed + _CRC.pack(_crc(framed))


def decode(octets: bytes) -> Message:
    """Return the message in all of `octets`; raise MessageError if it is invalid."""
    if len(octets) < _HEADER.size:
        raise MessageError(
            f"a message must have a header of {_HEADER.size} bytes, but is cut short after {len(octets)}"
        )
    sync, type_number, sequence, size = _HEADER.unpack_from(octets)
    if sync != framing.SYNC:
        raise MessageError(f"a message must begin with the sync word 0x{framing.SYNC:04X}, not 0x{sync:04X}")
    if len(octets) < message_nbytes(size):
        raise MessageError(
            f"a message with a payload of {size} bytes must have {message_nbytes(size)} bytes, "
            f"but is cut short after {len(octets)}"
        )
    if len(octets) > message_nbytes(size):
        raise MessageError(
            f"a message with a payload of {size} bytes must have the length {message_nbytes(size)}, not {len(octets)}"
        )
    framed = octets[: -_CRC.size]
    (checksum,) = _CRC.unpack_from(octets, len(framed))
    if checksum != _crc(framed):
        raise MessageError(f"the checksum of this message must be 0x{_crc(framed):04X}, not 0x{checksum:04X}")
    return Message(_type_of(type_number), sequence, octets[_HEADER.size : _HEADER.size + size])


def _type_of(number: int) -> MessageType:
    try:
        return MessageType(number)
    except ValueError:
        known = ", ".join(f"{each.value} ({each.name})" for each in MessageType)
        raise MessageError(f"the type of a message must be one of {known}, not {number}") from None


def _crc(framed: bytes) -> int:
    """Return the CRC-16 of everything after the sync word: CCITT's polynomial, from all ones."""
    return binascii.crc_hqx(framed[2:], 0xFFFF)
