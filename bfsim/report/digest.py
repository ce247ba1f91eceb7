"""Two fingerprints of a run: of all that its result depends on, and of every cycle number in it.

Equal identities must give equal cycles, on every machine.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence

from pydantic_core import to_jsonable_python

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
    plain = to_jsonable_python(value, fallback=dict)
    return json.dumps(plain, sort_keys=True, separators=(",", ":")).encode()
