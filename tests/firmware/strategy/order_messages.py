"""Orders as they come over SPI, for tests: bytes of messages, and why the firmware refuses them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from bfsim.api import FrameSize
from tinyphoon.fields import to_words
from tinyphoon.strategy.modes import INDOOR_FIELD
from tinyphoon.strategy.order_checks import models_refusal, picture_refusal, words_refusal
from tinyphoon.strategy.orders import AREA, CAMERA, MODE_WORDS, ORDER_WORDS, shared_order_buffers
from tinyphoon.strategy_unit.messages import Message, MessageType, encode
from tinyphoon.strategy_unit.payloads import payload

FULL = FrameSize(320, 240)
TABLES = {each.name: each.values for each in shared_order_buffers(FULL, "l2_shared")}
NAMES = [each.name for each in MODE_WORDS]
GOOD = to_words(INDOOR_FIELD)
MESSAGE = encode(Message(MessageType.MODE, 3, payload(GOOD)))


def received(octets: bytes) -> tuple[np.ndarray, int]:
    """The buffer of messages, with what was in it before, and the bytes that came."""
    message = np.full(ORDER_WORDS, 0xA5A5, np.uint16)
    taken = octets[: message.nbytes]
    message.view(np.uint8)[: len(taken)] = np.frombuffer(taken, np.uint8)
    return message, len(taken)


def framed(kind: MessageType, words: Sequence[int]) -> np.ndarray:
    """A whole message with these words."""
    return received(encode(Message(kind, 7, payload(words))))[0]


def refusal_of_mode(words: Sequence[int], full: FrameSize = FULL, halvings: int = 2) -> int:
    """Why these words are no mode, as core A finds out."""
    message = framed(MessageType.MODE, words)
    found = words_refusal(message, TABLES["mode_limits"].astype(np.int32), 1)
    size = np.array([full.width_px, full.height_px], np.int32)
    return found or picture_refusal(message, CAMERA, AREA, size, halvings, 16)


def refusal_of_models(records: Sequence[Sequence[int]]) -> int:
    """Why these records are no models."""
    message = framed(MessageType.MODELS, [word for each in records for word in each])
    found = words_refusal(message, TABLES["model_limits"].astype(np.int32), 8)
    return found or models_refusal(message)


def changed(**words: int) -> list[int]:
    """The words of the starting mode, some of them changed; `__` stands for the dot in their names."""
    names = {name.replace("__", "."): value for name, value in words.items()}
    return [names.get(name, word) for name, word in zip(NAMES, GOOD, strict=True)]


def model(number: int, **changes: Any) -> list[int]:
    """The words of a model of its own colour."""
    words = {"number": number, "shape": 3, "colours": 1 << number, "width_mm": 50, "height_mm": 40, "depth_mm": 50, "floor_mm": 0,
             "aspect_min": 16, "aspect_max": 32}  # fmt: skip
    return list((words | changes).values())
