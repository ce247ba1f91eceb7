"""Substitutes for characters that the terminal's encoding lacks: similar ones of ASCII, so that tables stay tables."""

from __future__ import annotations

import codecs

NAME = "bfsim.look_alikes"
"""Name of the error handler for streams."""
_LIKE = str.maketrans("█▓░▏▁▂▃▄▅▆▇◆■│┌└─…→≥≤°µ·–×✅❌", "#=:|_.-=+*oo#|++-~>><ou.-x+!")  # noqa: RUF001 - they look alike
"""A bar and its parts stay distinct, and so do the steps of a trend."""


def _look_alike(error: UnicodeError) -> tuple[str, int]:
    """Return the substitutes for characters that cannot be encoded: a question mark if nothing in ASCII is similar."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    alike = error.object[error.start : error.end].translate(_LIKE)
    return alike.encode("ascii", "replace").decode("ascii"), error.end


codecs.register_error(NAME, _look_alike)
