"""What the strategy unit may order, by name → the payload of its message."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bfsim.api import FirmwareError, shown
from tinyphoon.fields import named_words
from tinyphoon.strategy.modes import INDOOR_FIELD
from tinyphoon.strategy_unit.plain_models import words_of_models


def payload(words: Sequence[int]) -> bytes:
    """Return words as they go over the SPI."""
    return np.array(words, np.int64).astype("<i4").tobytes()


def mode_payload(names: object, at: str = "mode") -> bytes:
    """Return the payload of the mode that differs from `INDOOR_FIELD` by `names`: fields, or fields of fields.

    Raises FirmwareError that names the field under `at`.
    """
    return payload(named_words(INDOOR_FIELD, names, at))


def models_payload(models: object, at: str = "models") -> bytes:
    """Return the payload of models: each the name of one of `MODELS`, or in plain words (`plain_models.py`).

    Raises FirmwareError that names the model or its field under `at`.
    """
    if not isinstance(models, list) or not models:
        raise FirmwareError(f"{at} must be a list of them, not {shown(models)}")
    return payload(words_of_models(models, at))


BY_NAME = {"mode": mode_payload, "models": models_payload}
"""What the strategy unit may order by name."""
