"""The conditions of #if and #elif: integer expressions of C over macros and `defined`."""

from __future__ import annotations

import re
from collections.abc import Mapping

from bfsim.errors import LinkError
from bfsim.linker.macros import Macro, MacroError, expand

_DEFINED = re.compile(r"\bdefined\s*(?:\(\s*(\w+)\s*\)|(\w+))")
_PLAIN = re.compile(r"[!\s]*[01]\s*")


def holds(condition: str, macros: Mapping[str, Macro]) -> bool:
    """Return whether `condition` is not 0; names that no macro defines are 0. Raise MacroError if it has no value."""

    def is_defined(use: re.Match[str]) -> str:
        return "1" if (use[1] or use[2]) in macros else "0"

    # A macro may stand for a condition of its own, as INSTR_CACHE does in the default LDFs.
    expanded = _DEFINED.sub(is_defined, expand(_DEFINED.sub(is_defined, condition), macros))
    if _PLAIN.fullmatch(expanded):
        return (expanded.count("!") + expanded.count("1")) % 2 == 1
    from bfsim.linker.grammar import parse_condition  # it takes 100 ms, and few conditions need it

    try:
        return parse_condition(expanded) != 0
    except LinkError as error:
        said = condition if len(condition) <= 60 else f"{condition[:60]}..."
        raise MacroError(f"condition must be an expression of integers, not '{said}': {error}") from None
