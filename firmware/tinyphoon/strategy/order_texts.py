"""Why an order is refused, in words for the report. The chip itself knows only the numbers of `order_checks.py`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bfsim.api import FrameSize
from tinyphoon.areas import LEAST_AREA_PX
from tinyphoon.fields import Word
from tinyphoon.strategy.framing import FRAME_BYTES, HEADER_WORDS, MODE, MODELS, SYNC
from tinyphoon.strategy.order_checks import (
    ABOVE,
    AREA,
    BALL_SIZE,
    CHECKSUM,
    CUT_SHORT,
    LENGTH,
    NO_SYNC,
    RANGE,
    SAME_MODEL,
    SAME_NUMBER,
    SHARED_COLOURS,
    SIZE,
    TOO_LONG,
    TOTAL,
    TYPE,
    WHICH_BIT,
)

TYPES = {MODE: "MODE", MODELS: "MODELS"}


def refusal_text(
    refusal: int,
    message: NDArray[np.uint16],
    nbytes: int,
    mode: Sequence[Word],
    model: Sequence[Word],
    full: FrameSize,
) -> str:
    """Return the sentence for a refusal of the `message` of `nbytes` bytes.

    `mode` and `model`: the words of these orders. `full`: size of the pictures that the buffers are made for.
    """
    reason, which = refusal & (1 << WHICH_BIT) - 1, refusal >> WHICH_BIT
    if reason in (CUT_SHORT, NO_SYNC, TOO_LONG, CHECKSUM, TYPE):
        return f"refused a message: {_frame_text(reason, message, nbytes)}"
    kind, sequence = TYPES[int(message[1])], int(message[2])
    words = mode if kind == "MODE" else model
    payload_bytes = int(message[3])
    if reason == LENGTH:
        text = _length_text(words, payload_bytes)
    else:
        values = message[HEADER_WORDS : HEADER_WORDS + payload_bytes // 2].view(np.int32).tolist()
        text = _order_text(reason, which, words, values, full)
    return f"refused {kind} {sequence}: {text}"


def _frame_text(reason: int, message: NDArray[np.uint16], nbytes: int) -> str:
    words = message.tolist()
    if reason == CUT_SHORT and nbytes < FRAME_BYTES:
        return f"it must have {FRAME_BYTES} bytes at least, but is cut short after {nbytes}"
    whole = FRAME_BYTES + words[3] + words[3] % 2
    return {
        NO_SYNC: f"it must begin with the sync word 0x{SYNC:04X}, not 0x{words[0]:04X}",
        CUT_SHORT: f"with a payload of {words[3]} bytes it must have {whole} bytes, but is cut short after {nbytes}",
        TOO_LONG: f"with a payload of {words[3]} bytes it must have {whole} bytes, not {nbytes}",
        CHECKSUM: f"its checksum must not be 0x{words[nbytes // 2 - 1]:04X}",
        TYPE: f"its type must be {MODE} (MODE) or {MODELS} (MODELS), not {words[1]}",
    }[reason]


def _length_text(words: Sequence[Word], payload_bytes: int) -> str:
    records = "" if any(each.name.startswith("area") for each in words) else " for each of 1 to 8 models"
    return f"it must have {4 * len(words)} bytes{records}, not {payload_bytes}"


def _order_text(
    reason: int, which: int, words: Sequence[Word], values: Sequence[int], full: FrameSize
) -> str:
    names = [each.name for each in words]
    if reason in (RANGE, ABOVE):
        record, number = divmod(which, len(words))
        word, at = words[number], f" (model {record})" if len(values) > len(words) else ""
        if reason == RANGE:
            return f"{word.demand}, not {values[which]}{at}"
        other = record * len(words) + names.index(word.at_most)
        return (
            f"{word.name} must be at most {word.at_most}, which is {values[other]}, not {values[which]}{at}"
        )
    if reason == TOTAL:
        added = [each.name for each in words if each.total]
        return f"{', '.join(added)} must be at most {words[which].total} together"
    if reason in (SIZE, AREA):
        camera, area = values[names.index("camera.width") :][:2], values[names.index("area.x") :][:4]
        size = FrameSize(*camera) if camera[0] else full
        return {
            SIZE: f"pictures must be of {full}, which the buffers hold, or a half or a quarter of it, not of {size}",
            AREA: f"area must be {LEAST_AREA_PX}x{LEAST_AREA_PX} px at least and lie in the {size} of the pictures, "
            f"not be {area[2]}x{area[3]} from ({area[0]}, {area[1]}) on",
        }[reason]
    return {
        BALL_SIZE: f"model {which} must be as high and as deep as wide, since it is a ball",
        SAME_NUMBER: f"model {which} must have a number of its own, not that of one before it",
        SHARED_COLOURS: f"model {which} must have all colours in common with one before it, or none",
        SAME_MODEL: f"model {which} must differ in colour or shape from those before it",
    }[reason]
