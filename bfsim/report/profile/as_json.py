"""The profile of a run as JSON: everything in its tables, complete."""

from __future__ import annotations

from typing import Any

from bfsim.report.jsonable import json_text, jsonable
from bfsim.report.profile.buffers import buffers_of, traffic_of
from bfsim.report.profile.callers import callers_of
from bfsim.report.profile.frames import worst_frames
from bfsim.report.profile.reason_tables import reasons_of
from bfsim.report.profile.sentences import sentences_of
from bfsim.report.profile.view import View
from bfsim.report.what_ran.digest import cycle_digest, identity_digest
from bfsim.trace import RunRecord

SCHEMA = "bfsim.profile/1"
"""Name and version of the layout; the version rises when the meaning of a key changes or a key goes away."""


def profile_json(run: RunRecord, core: str | None = None, stage: str | None = None, top: int = 20) -> str:
    """Return the profile of a run of at least one frame, with the `top` worst frames."""
    view = View.of(run, core, stage, top)
    median, worst = worst_frames(run, core, stage, top)
    reasons = [
        {"reason": kind, "stage": name, "owner": owner, "cclk": cclk}
        for kind, owners in reasons_of(view).items()
        for (name, owner), cclk in owners.most_common()
    ]
    plain: dict[str, Any] = {
        "schema": SCHEMA,
        "digests": {"identity": identity_digest(run.identity), "cycles": cycle_digest(run.frames)},
        "sentences": sentences_of(run, core, stage),
        "profile": view.profile,
        "reasons": reasons,
        "buffers": buffers_of(run, core, stage),
        "traffic": traffic_of(run),
        "callers": callers_of(run, core, stage),
        "median_frame": median,
        "worst_frames": worst,
    }
    return json_text(jsonable(plain, fallback=dict))
