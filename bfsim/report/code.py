"""How much of a run was counted on object code, instruction by instruction, and how much was estimated."""

from __future__ import annotations

from bfsim.trace import RunRecord

MODEL_ERROR_PERCENT = 13
"""Of a kernel that the model never saw, on average. [measured] docs/accuracy.md"""
OF_FILES = "object code of files"


def code_in_words(run: RunRecord) -> str:
    """Say whose object code ran, for which part of the issue cycles; nothing where all was estimated as was asked for."""
    share = run.object_share
    if not share:
        return (
            f"{run.identity.code}; a kernel is off by some {MODEL_ERROR_PERCENT} %"
            if run.identity.code
            else ""
        )
    whose = run.identity.code or OF_FILES
    if share == 1:
        return whose
    return f"{whose}: {100 * share:.2f} % of the issue cycles; all others are estimated"
