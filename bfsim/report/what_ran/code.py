"""How much of a run was timed on object code, instruction by instruction, and how much was estimated."""

from __future__ import annotations

from bfsim.trace import RunRecord

MODEL_ERROR_PERCENT = 10
"""The mean error for a kernel that the model has never seen. [measured] docs/accuracy.md"""
TRUST = "Trust", "docs/accuracy.md: how far, and what is assumed or not modelled"
"""Shown beside the code that ran and its timing: where to find the measured errors of both. A line of 80 columns."""
OF_FILES = "object code of files"


def code_in_words(run: RunRecord) -> str:
    """Say whose object code ran, for which part of the issue cycles; "" if everything was estimated, as asked."""
    share, code = run.object_share, run.identity.code
    has_code = bool(run.identity.code_digest)
    if not (share or has_code):
        return f"{code}; a kernel is off by some {MODEL_ERROR_PERCENT} %" if code else ""
    of_files = ", ".join(filter(None, (OF_FILES, run.identity.file_compiler)))
    whose = code if has_code else of_files
    if share == 1:
        return whose
    others = "estimated" if has_code else code or "estimated"
    return f"{whose}: {100 * share:.2f} % of the issue cycles; all others are {others}"
