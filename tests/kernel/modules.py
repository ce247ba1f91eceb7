"""Modules made from text, in files: a kernel must have a source that can be read again."""

from __future__ import annotations

import importlib.util
import itertools
import textwrap
from pathlib import Path
from types import ModuleType

from bfsim.kernel import Kernel

HEADER = """from __future__ import annotations

from bfsim.kernel import f32, i8, i16, i32, kernel, quotient, remainder, u8, u16, u32

"""
HEADER_LINES = HEADER.count("\n")
_numbers = itertools.count()


def import_text(text: str, folder: Path, name: str | None = None) -> ModuleType:
    """Write `text` below HEADER into a new file of `folder` and import it; `name` is the module's, if it matters."""
    name = name or f"kernels_{next(_numbers)}"
    path = folder / f"{name}.py"
    path.write_text(HEADER + textwrap.dedent(text), "utf-8")
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def kernel_of(text: str, folder: Path, helpers: str = "") -> Kernel:
    """The kernel `f` that is written in `text`, without its decorator; `helpers` are kernels that it calls."""
    found: Kernel = import_text(f"{helpers}@kernel\n{textwrap.dedent(text).strip()}\n", folder).f
    return found
