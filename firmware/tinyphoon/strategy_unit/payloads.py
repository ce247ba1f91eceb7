"""Orders of the strategy unit by name → the payloads of their messages."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bfsim.api import FirmwareError, shown
from tinyphoon.fields import named_words
from tinyphoon.strategy.modes import INDOOR_FIELD, Mode
from tinyphoon.strategy_unit.plain_models import words_of_models


def payload(words: Sequence[int]) -> bytes:
    """Return words as bytes for the SPI."""
    return np.array(words, np.int64).astype("<i4").tobytes()


def mode_payload(names: object, at: str = "mode", mode: Mode = INDOOR_FIELD) -> bytes:
    """Return the payload of the mode that differs from `mode` by `names`: fields, or fields of fields.

    Raises FirmwareError that names the field under `at`.
    """
    return payload(named_words(mode, names, at))


def models_payload(models: object, at: str = "models") -> bytes:
    """Return the payload of models: each is the name of one of `MODELS`, or described (`plain_models.py`).

    Raises FirmwareError that names the model or its field under `at`.
    """
    if not isinstance(models, list) or not models:
        raise FirmwareError(f"{at} must be a list of them, not {shown(models)}")
    return payload(words_of_models(models, at))


BY_NAME = "mode", "models"
"""What the strategy unit may order by name."""


def payload_by_name(name: str, order: object, at: str, mode: Mode) -> bytes:
    """Return the payload of an order of `BY_NAME`; fields that a mode does not name come from `mode`."""
    return mode_payload(order, at, mode) if name == "mode" else models_payload(order, at)
