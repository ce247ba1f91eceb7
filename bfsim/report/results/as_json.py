"""All records of a run, as plain dictionaries and lists for `--json`."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any

from bfsim.report.budget.budget import budget_of
from bfsim.report.budget.owners import owner_frames
from bfsim.report.jsonable import indented, jsonable
from bfsim.report.run.warnings import warnings_of
from bfsim.report.what_ran.digest import cycle_digest, identity_digest
from bfsim.trace import RunRecord, RunWarning

SCHEMA = "bfsim.run/4"
"""Name and version of the layout; the version rises when the meaning of a key changes or a key goes away."""


Seen = Mapping[int, Mapping[str, Any]]
"""What was seen in each frame (`seen_json`), by the frame's index."""

_NUMBERS = re.compile(r"\[\n\s+(-?[\d.e+-]+(?:,\n\s+-?[\d.e+-]+)*)\n\s+\]")


_FRAMES = "\0frames"
"""Stands for the frames while the text around them is made."""


def as_json(run: RunRecord) -> dict[str, Any]:
    """Return the records of a run of at least one frame, and with them warnings, budget and digests.

    Keys are the field names of `bfsim.trace` and `bfsim.report.budget.budget`, so each carries its unit.
    """
    records = {each.name: getattr(run, each.name) for each in fields(RunRecord)}
    plain: dict[str, Any] = jsonable(records, fallback=_plain)
    for core in (core for frame in plain["frames"] for core in frame["cores"]):
        del core["owners"]  # `owners` has them, frame by frame
    budget = jsonable(budget_of(run), fallback=dict)
    digests = {"identity": identity_digest(run.identity), "cycles": cycle_digest(run.frames)}
    warnings = [_flat(each) for each in warnings_of(run)]
    del plain["assumptions"]  # they are among the warnings
    return {
        "schema": SCHEMA,
        "digests": digests,
        "warnings": warnings,
        "identity": plain.pop("identity"),
        "budget": budget,
        **plain,
        "owners": jsonable(list(owner_frames(run))),
    }


def _plain(value: Any) -> Any:
    return dict(value) if isinstance(value, Mapping) else []


def _flat(warning: RunWarning) -> dict[str, Any]:
    """Return a warning with its numbers beside kind and text."""
    results = {"results": list(warning.results)} if warning.results else {}
    return {"kind": str(warning.kind), "text": warning.text, **results, **warning.numbers}


def json_chunks(run: RunRecord, seen: Seen | None = None) -> Iterator[str]:
    """Yield `as_json` as indented text that ends in a line feed, with lists of numbers on one line.

    Each chunk holds a frame, so that what was seen in all frames need not be in memory at once.
    """
    plain = as_json(run)
    frames, plain["frames"] = plain["frames"], [_FRAMES]
    before, _, after = _text(plain).partition(json.dumps(_FRAMES))
    yield before
    for number, frame in enumerate(frames):
        found = {"seen": seen[frame["index"]]} if seen and frame["index"] in seen else {}
        yield ",\n    " * (number > 0) + _text(frame | found).replace("\n", "\n    ")
    yield f"{after}\n"


def _text(plain: Mapping[str, Any]) -> str:
    return _NUMBERS.sub(lambda found: f"[{' '.join(found[1].split())}]", indented(plain))
