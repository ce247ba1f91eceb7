"""Modes and models of the strategy unit: received, checked word by word, and obeyed from the next frame on (T §5.2.6).

Core A takes the messages before the first frame and at the end of each. The words of a good one go to L2, where both
cores copy them from at the beginning of a frame; a bad one is counted, reported with the reason, and changes nothing. A
mode is all its words, and a table of models all its models; the number of words is the version of the format.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.api import Buffer, Core, Frame, FrameSize, Row, i32, kernel, u16
from tinyphoon.areas import LEAST_AREA_PX, Area, principal_shift, see
from tinyphoon.fields import Word, from_words, to_words, words_of
from tinyphoon.geometry import look_at
from tinyphoon.strategy.colour_names import names_of
from tinyphoon.strategy.framing import FRAME_BYTES, MODE, message_type
from tinyphoon.strategy.models import (
    MODEL_CAPACITY,
    MODEL_NUMBER,
    MODEL_WORDS,
    MODELS,
    ObjectModel,
    colour_groups,
    model_words,
)
from tinyphoon.strategy.modes import INDOOR_FIELD, Mode
from tinyphoon.strategy.order_checks import (
    LIMIT_WORDS,
    frame_refusal,
    models_refusal,
    order_word,
    picture_refusal,
    words_refusal,
)
from tinyphoon.strategy.order_texts import refusal_text

ORDER_WORDS = 256  # of 16 bits: room for a message of the strategy unit
HALVINGS = 2  # of the pictures' size, as sensors do: VGA to QQVGA

MODE_WORDS = words_of(Mode)
MODEL_FIELDS = words_of(ObjectModel)
assert FRAME_BYTES + 4 * max(len(MODE_WORDS), MODEL_CAPACITY * MODEL_WORDS) <= 2 * ORDER_WORDS
_NAMES = [each.name for each in MODE_WORDS]
CAMERA, AREA = _NAMES.index("camera.width"), _NAMES.index("area.x")


def shared_order_buffers(size: FrameSize, section: str) -> Sequence[Buffer]:
    """Return the buffers that both cores share: orders in force, limits of orders, and incoming messages."""
    return (
        Buffer("orders", u16, ORDER_WORDS, section),
        Buffer("ordered_mode", i32, len(MODE_WORDS), section, values=np.array(to_words(INDOOR_FIELD))),
        Buffer("ordered_models", i32, MODEL_CAPACITY * MODEL_WORDS, section, values=model_words(MODELS)),
        _limits("mode_limits", MODE_WORDS),
        _limits("model_limits", MODEL_FIELDS),
        Buffer("full_size", i32, 2, section, values=np.array([size.width_px, size.height_px])),
    )


def order_buffers() -> Sequence[Buffer]:
    """Return a core's own copy of the mode. The copy of the models is in `models.py`."""
    return (Buffer("mode", i32, len(MODE_WORDS), "data1"),)


def _limits(name: str, words: Sequence[Word]) -> Buffer:
    """Return the limits of words, in the SDRAM of the images: they are read only when a message arrives."""
    names = [each.name for each in words]
    limits = [(each.lowest, each.highest, each.step, names.index(each.at_most), each.total) for each in words]
    return Buffer(name, i32, LIMIT_WORDS * len(words), "sdram_bank2", values=np.ravel(limits))


@kernel
def store_order(message: u16[:], words: i32[:]) -> None:
    """Store the words of an order that is obeyed; the rest of `words` is 0."""
    count = i32(message[3]) >> 2
    for word in range(count):
        words[word] = order_word(message, word)
    for word in range(count, len(words)):
        words[word] = 0


@kernel
def copy_order(words: i32[:], copy: i32[:]) -> None:
    """Copy words that both cores share to a core's own."""
    for word in range(len(words)):
        copy[word] = words[word]


class Orders:
    """The messages of the strategy unit since the last report to it."""

    def __init__(self, core: Core) -> None:
        self._core = core
        self._taken = self._refused = self._refusal = 0

    def take(self) -> Generator[Any, Any, None]:
        """Take the waiting messages and put the good ones in force, from the next frame on; remark on each bad one."""
        core, message = self._core, self._core.array("orders")
        while nbytes := (yield from core.receive(message)):
            refusal = yield from _obey(core, message, nbytes)
            if not refusal:
                self._taken += 1
                continue
            self._refused, self._refusal = self._refused + 1, refusal
            words = MODE_WORDS, MODEL_FIELDS
            core.remark(refusal_text(refusal, message.array, nbytes, *words, _full_size(core)))

    def close(self) -> int:
        """Publish the counts `orders_taken` and `orders_refused`, and return why the last bad one was refused, or 0."""
        self._core.publish(orders_taken=self._taken, orders_refused=self._refused)
        refusal = self._refusal
        self._taken = self._refused = self._refusal = 0
        return refusal


def _obey(core: Core, message: Row, nbytes: int) -> Generator[Any, Any, int]:
    """Check a message and store its words if it is good; return why it is refused, or 0."""
    refusal: int = yield core.run(frame_refusal, message, nbytes)
    if refusal:
        return refusal
    is_mode = (yield core.run(message_type, message)) == MODE
    limits, most = (core.array("mode_limits"), 1) if is_mode else (core.array("model_limits"), MODEL_CAPACITY)
    refusal = yield core.run(words_refusal, message, limits, most)
    if refusal:
        return refusal
    if is_mode:
        # tables of a recording are for one size of pictures
        halvings = 0 if core.has_buffer("places") else HALVINGS
        full = core.array("full_size")
        refusal = yield core.run(picture_refusal, message, CAMERA, AREA, full, halvings, LEAST_AREA_PX)
    else:
        refusal = yield core.run(models_refusal, message)
    if not refusal:
        yield core.run(store_order, message, core.array("ordered_mode" if is_mode else "ordered_models"))
    return refusal


def see_by(core: Core, frame: Frame, mode: Mode) -> Generator[Any, Any, Area]:
    """Use the part of a picture that the mode wants, and set the camera for the next ones; return that area."""
    full = _full_size(core)
    area = see(core, frame, mode.camera, mode.area, full)
    halvings = halvings_of(core, frame)
    yield core.run(look_at, core.array("geometry"), *principal_shift(frame, area, halvings), halvings)
    return area


def halvings_of(core: Core, frame: Frame) -> int:
    """Return how often a picture's size was halved from the recorded one."""
    return (_full_size(core).width_px // frame.width).bit_length() - 1


def _full_size(core: Core) -> FrameSize:
    return FrameSize(*core.array("full_size").array.tolist())


def read_mode(core: Core) -> Generator[Any, Any, Mode]:
    """Copy the orders in force into the core's own memory, for this frame, and return them."""
    own = core.array("mode"), core.array("models")
    for name, copy in zip(("ordered_mode", "ordered_models"), own, strict=True):
        yield core.run(copy_order, core.array(name), copy)
    return mode_in(*(each.array for each in own))


def mode_in(mode: NDArray[np.int32], models: NDArray[np.int32]) -> Mode:
    """Return the mode and the models that are in memory."""
    return _mode_of(tuple(mode.tolist()), tuple(models.tolist()))


@lru_cache(maxsize=4)
def _mode_of(mode: tuple[int, ...], models: tuple[int, ...]) -> Mode:
    """Return the mode of these words, which are nearly always those of the previous frame."""
    each_words = (models[first : first + MODEL_WORDS] for first in range(0, len(models), MODEL_WORDS))
    known = tuple(_model(each) for each in each_words if each[MODEL_NUMBER])
    ordered = from_words(INDOOR_FIELD, mode)
    blobs = replace(ordered.blobs, colour_groups=colour_groups(known))
    return replace(ordered, blobs=blobs, models=known)


def _model(words: tuple[int, ...]) -> ObjectModel:
    model = from_words(MODELS[0], words)
    names = {each.number: each.name for each in MODELS}
    return replace(model, name=names.get(model.number) or _what_it_is(model))


def _what_it_is(model: ObjectModel) -> str:
    """Return the description of a model with a new number: names do not go over the SPI."""
    return f"{' or '.join(names_of(model.colours))} {model.shape.name.lower()} {model.number}"
