"""Models of firmware of a few symbols, to be placed."""

from __future__ import annotations

from pathlib import Path

from bfsim.chip.boards import BOARDS
from bfsim.linker import Symbol
from bfsim.machine.code import object_file
from bfsim.placing.model import Model
from bfsim.running.inputs import read_placement

BOARD = BOARDS["cm-bf561"]


def model(ldf: str, *symbols: tuple[str, str, int, str | None]) -> Model:
    """A firmware of a few symbols: name, section, bytes and processor."""
    found = [
        Symbol(name, section, nbytes, processor=processor, object_file=object_file(name))
        for name, section, nbytes, processor in symbols
    ]
    return Model(BOARD, read_placement(Path(ldf), BOARD, {}, ()), found)
