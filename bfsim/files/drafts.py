"""Drafts: what is written beside its place, and put there when it is complete.

A draft is a folder with a lock on it for as long as its process lives. What a killed process left behind has no lock any
more, and the next one that writes in the same folder removes it. Knows nothing of what is written.
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO

from bfsim.files.locks import lock_folder

_PREFIX, _SUFFIX = ".bfsim-", ".draft"
_NAME = re.compile(re.escape(_PREFIX) + r"\w{8}" + re.escape(_SUFFIX))
"""Only such names, which nobody gives to anything else, are swept."""


@contextmanager
def draft_folder(where: Path) -> Iterator[Path]:
    """Yield a new folder in `where` that goes away, with all that is still in it, at the end of the `with` block.

    What killed processes left in `where` goes away at the beginning. Raises OSError where the system refuses.
    """
    sweep(where)
    unnamed = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=where))
    lock = lock_folder(unnamed)
    folder = unnamed.with_name(unnamed.name + _SUFFIX)
    unnamed.rename(folder)  # only now, with its lock on it, could it be swept
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if lock is not None:
            os.close(lock)


@contextmanager
def growing_draft(path: Path, writing: Callable[[], AbstractContextManager[None]]) -> Iterator[IO[bytes]]:
    """Yield a stream whose content takes its place at `path` on a clean exit of the `with` block; permissions are kept.

    After an error or Ctrl-C nothing is left of it, and a file that was at `path` before is untouched. What the system
    says against writing goes through `writing`.
    """
    with ExitStack() as stack:
        with writing():
            draft = stack.enter_context(draft_folder(path.parent)) / path.name
            stream = draft.open("xb")
        try:
            yield stream
            with writing():
                stream.close()
                if path.exists():
                    shutil.copymode(path, draft)
                draft.replace(path)
        finally:
            # a full disk refuses what is still buffered; the draft goes away all the same
            with suppress(OSError):
                stream.close()


def sweep(where: Path) -> None:
    """Remove the drafts in `where` that no process holds any more; what cannot be removed stays."""
    with suppress(OSError):
        for folder in [each for each in where.iterdir() if _NAME.fullmatch(each.name)]:
            lock = lock_folder(folder)
            if lock is not None:
                shutil.rmtree(folder, ignore_errors=True)
                os.close(lock)
