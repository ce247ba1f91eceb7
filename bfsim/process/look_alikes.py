"""What is printed where the terminal's encoding lacks a character: one of ASCII that looks like it, so that tables stay tables."""

from __future__ import annotations

import codecs

NAME = "bfsim.look_alikes"
"""The error handler of a stream that says this."""
_LIKE = str.maketrans("█▓░▏▁▂▃▄▅▆▇◆■│┌└─…→≥≤°µ·–×✅❌", "#=:|_.-=+*oo#|++-~>><ou.-x+!")  # noqa: RUF001 - they look alike
"""A bar and its parts stay apart, and so do the steps of a trend."""


def _look_alike(error: UnicodeError) -> tuple[str, int]:
    """Return what is written in place of what cannot be: a question mark for what looks like nothing in ASCII."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    alike = error.object[error.start : error.end].translate(_LIKE)
    return alike.encode("ascii", "replace").decode("ascii"), error.end


codecs.register_error(NAME, _look_alike)
