"""Drafts: files that are written beside their place, and moved there when complete.

A draft is a folder that is locked as long as its process lives. What a killed process left behind is no longer locked, and the
next process that writes in the same folder removes it. This module knows nothing about the content.
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
"""Only such names are swept, which nothing else has."""


@contextmanager
def draft_folder(where: Path) -> Iterator[Path]:
    """Yield a new folder in `where`, which is removed with its contents at the end of the `with` block.

    First, remove what killed processes left in `where`. Raises OSError if the system refuses.
    """
    sweep(where)
    unnamed = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=where))
    lock = lock_folder(unnamed)
    folder = unnamed.with_name(unnamed.name + _SUFFIX)
    unnamed.rename(folder)  # only now, when it is locked, does it have a name that is swept
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if lock is not None:
            os.close(lock)


@contextmanager
def growing_draft(path: Path, writing: Callable[[], AbstractContextManager[None]]) -> Iterator[IO[bytes]]:
    """Yield a stream whose content becomes the file at `path` on a clean exit of the `with` block. Permissions are kept.

    After an error or Ctrl-C, nothing is left of it, and an earlier file at `path` is untouched. The system's refusals to
    write go through `writing`.
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
            # a full disk refuses what is still buffered; the draft is removed all the same
            with suppress(OSError):
                stream.close()


def sweep(where: Path) -> None:
    """Remove the drafts in `where` that no process holds any more. Those that cannot be removed stay."""
    with suppress(OSError):
        for folder in [each for each in where.iterdir() if _NAME.fullmatch(each.name)]:
            lock = lock_folder(folder)
            if lock is not None:
                shutil.rmtree(folder, ignore_errors=True)
                os.close(lock)
