"""Compiled Python: what looks at every access to a memory or at every word on a bus, through numba.

The machine code is kept in the cache of bfsim, in a folder named after the sources around it: a change in one file never
meets code that another file was compiled against.
"""

from __future__ import annotations

import hashlib
import importlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from bfsim.kernel import store

numba: Any = importlib.import_module("numba")  # its own types do not know all of its options
_extending: Any = importlib.import_module("numba.extending")
Function = TypeVar("Function", bound=Callable[..., Any])


@cache
def _folder(room: Path) -> str:
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in sorted(room.glob("*.py"))))
    return str(store.folder() / f"{room.name}-{digest.hexdigest()[:24]}")


def compiled(function: Function) -> Function:
    """Let `function` be compiled as a part of those that call it. Called from Python, it is plain Python."""
    made: Function = _extending.register_jitable(error_model="numpy")(function)
    return made


def entry(function: Function) -> Function:
    """Compile `function` and all that it calls at its first call from Python, or take it from the cache."""
    numba.config.CACHE_DIR = _folder(Path(function.__code__.co_filename).parent)
    try:
        made: Function = numba.njit(cache=True, no_cfunc_wrapper=True, error_model="numpy")(function)
    except RuntimeError:  # no folder can be written: compile in every process
        made = numba.njit(no_cfunc_wrapper=True, error_model="numpy")(function)
    return made


def callback(signature: Any, function: Callable[..., None]) -> int:
    """Compile `function` for calls from machine code, or take it from the cache; return its host address."""
    numba.config.CACHE_DIR = _folder(Path(function.__code__.co_filename).parent)
    try:
        made = numba.cfunc(signature, cache=True)(function)
    except RuntimeError:
        made = numba.cfunc(signature)(function)
    _kept.append(made)  # the code lives as long as this object
    return int(made.address)


_kept: list[Any] = []
