"""The colour reduction of any picture, for people: each colour with its name, and the white balance to order."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bfsim.api import Colour, FirmwareError, NamedColour, PictureColours, Script
from tinyphoon.fields import from_words, words_of
from tinyphoon.stages.blob_detection import hues
from tinyphoon.stages.colour_reduction import AS_IT_IS, HUES, SINGLE_COLOURS, balance_row, colour_row
from tinyphoon.stages.edge_detection import EdgeThresholds
from tinyphoon.strategy.colour_names import COLOUR_NAMES, HUE_DEG, WITHOUT_HUE, colours_named
from tinyphoon.strategy.modes import INDOOR_FIELD, Mode
from tinyphoon.strategy_unit.entries import Entry, entries_of
from tinyphoon.strategy_unit.messages import MessageError, MessageType, decode
from tinyphoon.tables import arctangent_table
from tinyphoon.view.colours import colour_of

WITHOUT_HUE_DRAWN: dict[str, Colour] = {"black": (20, 20, 20), "white": (255, 255, 255)}
NO_COLOUR: Colour = (128, 128, 128)

DARKEST, BRIGHTEST = 16, 240
"""The lumas used to measure a white balance: darker ones are noise, and brighter ones may be clipped at 255."""

LEAST_GAIN, MOST_GAIN = next(
    (each.lowest, each.highest) for each in words_of(EdgeThresholds) if each.name == "red_gain"
)


def picture_colours(
    picture: NDArray[np.uint8], script: Script, frame: int, mode: Mode = INDOOR_FIELD
) -> PictureColours:
    """Return the colours of a UYVY picture by the mode that a script has in force at `frame`, `mode` at first."""
    thresholds = mode_at(script, frame, mode).edges
    atan, words = arctangent_table(), np.zeros((picture.shape[0], picture.shape[1] // 2), np.uint32)
    for line, found in zip(picture.copy(), words, strict=True):
        if not thresholds.is_balanced:
            balance_row(line, *thresholds.gains)
        colour_row(line, atan, SINGLE_COLOURS, found, *thresholds.colour_limits)
    known = dict(_colours())
    numbers = np.zeros(words.shape, np.uint8)
    for number, word in enumerate(known):
        numbers[words == word] = number
    return PictureColours(numbers=numbers, named=tuple(known.values()), notes=(_balance(picture),))


def mode_at(script: Script, frame: int, mode: Mode = INDOOR_FIELD) -> Mode:
    """Return the mode in force in a frame, `mode` at first. Raises FirmwareError for a forbidden order."""
    for entry in entries_of(script, mode):
        if entry.after_frames == 0 or entry.after_frames < frame:
            mode = _ordered(entry) or mode
    return mode


def _ordered(entry: Entry) -> Mode | None:
    """Return the mode of an order, if it is one; like the chip, ignore damaged messages."""
    try:
        message = decode(entry.message.octets)
    except MessageError:
        return None
    known, words = words_of(Mode), np.frombuffer(message.payload, "<i4").tolist()
    if message.type is not MessageType.MODE or len(words) != len(known):
        return None
    for each, word in zip(known, words, strict=True):
        if not each.lowest <= word <= each.highest:
            raise FirmwareError(f"{each.demand}, not {word}")
    return from_words(INDOOR_FIELD, words)


def _colours() -> Iterator[tuple[int, NamedColour]]:
    """Yield the word and the name of every colour, in the order of the hues."""
    names = {colours_named(each): each for each in COLOUR_NAMES}
    for hue in range(HUES):
        word = hues(hue, hue)
        (name,) = (name for colours, name in names.items() if colours & word)
        degrees = hue * HUE_DEG, (hue + 1) * HUE_DEG
        yield word, NamedColour(name=name, colour=colour_of(word), hue_deg=degrees)
    for name, word in WITHOUT_HUE.items():
        yield word, NamedColour(name=name, colour=WITHOUT_HUE_DRAWN[name])
    yield 0, NamedColour(name="no colour", colour=NO_COLOUR)


def _balance(picture: NDArray[np.uint8]) -> str:
    """Return the gains that would make a picture grey on average."""
    luma = picture[:, 1::2].astype(float)
    seen = (luma >= DARKEST) & (luma <= BRIGHTEST)
    if not seen.any():
        return f"too dark or too bright to measure a white balance: no luma of {DARKEST} to {BRIGHTEST}"
    u, v = (picture[:, first::4].repeat(2, axis=1)[seen].mean() - 128 for first in (0, 2))
    grey = luma[seen].mean()
    red, blue = (_gain(grey, grey + part) for part in (v / 0.713, u / 0.564))  # BT.601
    return f"grey on average with edges.red_gain {red} and edges.blue_gain {blue} ({AS_IT_IS} leaves it as it is)"


def _gain(grey: float, part: float) -> int:
    """Return the gain that brings red or blue, with mean `part`, to `grey`, within the limits of orders."""
    return round(min(max(AS_IT_IS * grey / max(part, 1), LEAST_GAIN), MOST_GAIN))
