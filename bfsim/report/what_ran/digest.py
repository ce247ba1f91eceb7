"""Two fingerprints of a run: one of everything that its result depends on, one of every cycle number in it.

Equal identities must give equal cycles, on every machine.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from typing import Any

from bfsim.trace import FrameRecord, Identity


def identity_digest(identity: Identity) -> str:
    """Return the sha256, in hex, over recording, firmware, board, LDF, compiler, feed, fidelity and versions."""
    return hashlib.sha256(_canonical(identity)).hexdigest()


def cycle_digest(frames: Sequence[FrameRecord]) -> str:
    """Return the sha256, in hex, over every cycle number of every frame and stage, in the order of the records."""
    digest = hashlib.sha256()
    for frame in frames:
        digest.update(_canonical(_cycles(frame)) + b"\n")
    return digest.hexdigest()


def _cycles(frame: FrameRecord) -> list[object]:
    cores = [(core.core, core.begin_cclk, core.end_cclk, core.stages) for core in frame.cores]
    return [frame.index, frame.last_line_cclk, frame.result_cclk, cores]


def _canonical(value: object) -> bytes:
    return json.dumps(value, sort_keys=True, separators=(",", ":"), default=_named).encode()


def _named(value: Any) -> dict[str, object]:
    """Return a record or a mapping as a dict."""
    if is_dataclass(value):
        return {each.name: getattr(value, each.name) for each in fields(value)}
    return dict(value)
