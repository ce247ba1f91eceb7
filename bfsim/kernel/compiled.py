"""Compiled Python: what looks at every access to a memory or at every word on a bus, through numba.

The machine code is kept in the cache of bfsim, in a folder named after the sources: a change in one file never meets code
that was compiled against another one.
"""

from __future__ import annotations

import hashlib
import importlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from bfsim.kernel import store

numba: Any = importlib.import_module("numba")  # its own types do not know all of its options
_extending: Any = importlib.import_module("numba.extending")
_caching: Any = importlib.import_module("numba.core.caching")
_ccallback: Any = importlib.import_module("numba.core.ccallback")
Function = TypeVar("Function", bound=Callable[..., Any])


ROOMS = ("kernel", "machine")
"""Folders of bfsim with compiled parts; those of one use numbers and functions of the other."""


@cache
def _folder() -> Path:
    package = Path(__file__).parent.parent
    digest = hashlib.sha256()
    for path in sorted(path for room in ROOMS for path in (package / room).rglob("*.py")):
        digest.update(path.read_bytes())
    return store.folder() / f"compiled-{digest.hexdigest()[:24]}"


@cache
def _keeps() -> bool:
    """Have numba keep what it compiles in the cache of bfsim, if that can be written, and nowhere else."""
    try:
        _folder().mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    numba.config.CACHE_DIR = str(_folder())
    return os.access(_folder(), os.W_OK)


class _Cache(_caching.FunctionCache):  # type: ignore[misc]  # see above
    """A cache that is never in the way: what is damaged in it is compiled again, and on a full disk nothing is kept."""

    @contextmanager
    def _guard_against_spurious_io_errors(self) -> Iterator[None]:
        try:
            yield
        except Exception:  # noqa: BLE001 - damaged data fail in any way
            with suppress(OSError):
                self.flush()


def is_kept(name: str) -> bool:
    """Return whether the cache has machine code of the entry `name`, "MODULE.FUNCTION"; also if there is no cache to have it."""
    return not _keeps() or any(_folder().rglob(f"{name}-*.nbi"))


def compiled(function: Function) -> Function:
    """Let `function` be compiled as a part of those that call it. Called from Python, it is plain Python."""
    made: Function = _extending.register_jitable(error_model="numpy")(function)
    return made


def entry(function: Function) -> Function:
    """Compile `function` and all that it calls at its first call from Python, or take it from the cache."""
    made: Any = numba.njit(no_cfunc_wrapper=True, error_model="numpy")(function)
    if _keeps():
        made._cache = _Cache(function)  # noqa: SLF001 - numba's own cache takes its place by an option only
    return cast("Function", made)


def callback(signature: Any, function: Callable[..., None]) -> int:
    """Compile `function` for calls from machine code, or take it from the cache; return its host address."""
    made = _ccallback.CFunc(function, (signature.args, signature.return_type), {}, {})
    if _keeps():
        made._cache = _Cache(function)  # noqa: SLF001 - as above
    made.compile()
    _kept.append(made)  # the code lives as long as this object
    return int(made.address)


_kept: list[Any] = []
