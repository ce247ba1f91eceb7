"""Everything a run left behind, as plain dictionaries and lists for `--json`."""

from __future__ import annotations

import json
from typing import Any

from pydantic_core import to_jsonable_python

from bfsim.report.budget import budget_of
from bfsim.report.digest import cycle_digest, identity_digest
from bfsim.trace import RunRecord

SCHEMA = "bfsim.run/1"
"""Name and version of the layout; the version rises when a key changes its meaning or goes away."""


def as_json(run: RunRecord) -> dict[str, Any]:
    """Return the records of a run of at least one frame as they are, and beside them the budget and the digests.

    Keys are the field names of `bfsim.trace` and `bfsim.report.budget`, so each carries its unit.
    """
    plain: dict[str, Any] = to_jsonable_python(run, fallback=dict)
    budget = to_jsonable_python(budget_of(run), fallback=dict)
    digests = {"identity": identity_digest(run.identity), "cycles": cycle_digest(run.frames)}
    return {"schema": SCHEMA, "digests": digests, "budget": budget, **plain}


def json_text(run: RunRecord) -> str:
    """Return `as_json` as indented text that ends in a line feed."""
    return json.dumps(as_json(run), indent=2, ensure_ascii=False) + "\n"
