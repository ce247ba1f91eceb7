"""Reads an LDF: preprocessor, then the grammar in ldf.lark, then `builder`. Errors carry a caret."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path

from bfsim.errors import LinkError, cut
from bfsim.linker.kept_scripts import kept_script
from bfsim.linker.predefined import ARCHITECTURE, chip_named
from bfsim.linker.preprocessor import preprocess
from bfsim.linker.script import LinkerScript
from bfsim.linker.source import Source

_OF_GNU = re.compile(r"\b(OUTPUT_FORMAT|OUTPUT_ARCH|PHDRS|ORIGIN)\b(?=\s*[({=])")
"""Commands of GNU ld's scripts that no LDF has."""


def parse_ldf(
    path: Path,
    defines: Mapping[str, str] | None = None,
    include_dirs: Sequence[Path] = (),
    chip: str = "",
) -> LinkerScript:
    """Read the LDF at `path`; raise LinkError with file, line, column, the source line and a caret.

    `defines` are macros besides those that VisualDSP++ predefines, which they can replace; `include_dirs` are
    searched for files that are not beside the including one; `chip` counts if the LDF has no ARCHITECTURE.
    """
    return _script(preprocess(path, defines or {}, include_dirs, chip))


@lru_cache(maxsize=8)
def _script(source: Source) -> LinkerScript:
    """Read a preprocessed LDF; many runs of a process, and many starts, have the same one."""
    return kept_script(source, lambda: _made(source))


def _made(source: Source) -> LinkerScript:
    from lark.exceptions import VisitError  # most starts find all LDFs

    from bfsim.linker.builder import ScriptBuilder
    from bfsim.linker.expressions import ExpressionError
    from bfsim.linker.grammar import parse_tree

    for architecture in ARCHITECTURE.finditer(source.expanded):
        if not chip_named(architecture[1]):  # the languages of other families differ, and so would the error
            problem = f"ARCHITECTURE must be a Blackfin such as ADSP-BF561, not {cut(architecture[1])}"
            raise source.error_at(architecture.start(1), problem)
    if of_gnu := _OF_GNU.search(source.expanded):
        problem = (
            f"an LDF must be in the language of VisualDSP++, and {of_gnu[1]} is a command of GNU ld: "
            "begin with a copy of a shipped LDF, such as the one that `bfsim ldf` shows"
        )
        raise source.error_at(of_gnu.start(), problem)
    try:
        return ScriptBuilder(source).transform(parse_tree(source))
    except VisitError as error:
        if isinstance(error.orig_exc, LinkError):
            raise error.orig_exc from None
        if isinstance(error.orig_exc, ExpressionError):
            raise source.error_at(error.orig_exc.offset, error.orig_exc.problem) from None
        raise
