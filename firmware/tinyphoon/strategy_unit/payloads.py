"""What the strategy unit may order, by name → the payload of its message."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bfsim.api import FirmwareError, shown
from tinyphoon.fields import named_words
from tinyphoon.strategy.models import MODELS
from tinyphoon.strategy.modes import INDOOR_FIELD


def payload(words: Sequence[int]) -> bytes:
    """Return words as they go over the SPI."""
    return np.array(words, np.int64).astype("<i4").tobytes()


def mode_payload(names: object, at: str = "mode") -> bytes:
    """Return the payload of the mode that differs from `INDOOR_FIELD` by `names`: fields, or fields of fields.

    Raises FirmwareError that names the field under `at`.
    """
    return payload(named_words(INDOOR_FIELD, names, at))


def models_payload(models: object, at: str = "models") -> bytes:
    """Return the payload of models: each the name of one of `MODELS`, or its fields; those not given are as in that one.

    Raises FirmwareError that names the model or its field under `at`.
    """
    if not isinstance(models, list) or not models:
        raise FirmwareError(f"{at} must be a list of them, not {shown(models)}")
    return payload(
        [word for number, each in enumerate(models) for word in _words_of_model(each, f"{at}.{number}")]
    )


def _words_of_model(wanted: object, at: str) -> list[int]:
    changes = {"name": wanted} if isinstance(wanted, str) else wanted
    known = {each.name: each for each in MODELS}
    if not isinstance(changes, Mapping) or changes.get("name") not in [*known]:
        raise FirmwareError(
            f"{at} must be or have the name of one of {', '.join(known)}, not be {shown(wanted)}"
        )
    return named_words(
        known[changes["name"]], {key: value for key, value in changes.items() if key != "name"}, at
    )


BY_NAME = {"mode": mode_payload, "models": models_payload}
"""What the strategy unit may order by name."""
