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
    """Return the sha256, in hex, over recording, firmware, board, LDF, compiler, feed and versions."""
    return _sha256(identity)


def cycle_digest(frames: Sequence[FrameRecord]) -> str:
    """Return the sha256, in hex, over every cycle number of every frame, in the order of the records."""
    return _sha256([_cycles(frame) for frame in frames])


def _cycles(frame: FrameRecord) -> list[object]:
    cores = [(core.core, core.begin_cclk, core.end_cclk, core.stages) for core in frame.cores]
    return [frame.index, frame.last_line_cclk, frame.result_cclk, cores]


def _sha256(value: object) -> str:
    plain = to_jsonable_python(value, fallback=dict)
    canonical = json.dumps(plain, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(canonical.encode()).hexdigest()
