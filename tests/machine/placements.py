"""Shipped LDFs, and others made of their text: code outside L1, caches beside what must not be there."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

from bfsim.linker import LinkerScript, parse_ldf
from bfsim.shipped import LDF_FOLDER

CODE = "INPUT_SECTIONS($OBJECTS(program))"
BEYOND_L1 = "INPUT_SECTIONS($OBJECTS(noncache_code program))"
CACHED_CODE_IN_SDRAM = "#if !CACHES                    // what L1 has no room for"


@cache
def shipped(name: str) -> LinkerScript:
    """Return one of the shipped placements, read once."""
    return parse_ldf(LDF_FOLDER / name)


@cache
def changed(name: str, *changes: tuple[str, str]) -> LinkerScript:
    """Return a shipped placement with parts of the text of core.ldfi replaced."""
    with tempfile.TemporaryDirectory() as folder:
        for path in LDF_FOLDER.iterdir():
            text = path.read_text()
            if path.name == "core.ldfi":
                for old, new in changes:
                    assert old in text, old
                    text = text.replace(old, new)
            (Path(folder) / path.name).write_text(text)
        return parse_ldf(Path(folder) / name)


def code_in(memory: str, name: str = "thesis.ldf") -> LinkerScript:
    """Return a shipped placement whose code is in L2 or in SDRAM."""
    away = (CODE, "")
    if memory == "SDRAM":
        return changed(name, away, (BEYOND_L1, BEYOND_L1.replace(" program", "")))
    return changed(name, away, (CACHED_CODE_IN_SDRAM, CACHED_CODE_IN_SDRAM.replace("!CACHES", "1")))
