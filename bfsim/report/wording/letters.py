"""Foreign text in the letters of Pillow's own font, in which pictures are lettered: it has hardly any beyond ASCII."""

from __future__ import annotations

from unicodedata import combining, normalize

_BEYOND_ASCII = frozenset("©«°±·»")


def in_letters_of_pillow(text: str) -> str:
    """Return text whose letters have lost their accents, and with a question mark for each that the font lacks.

    Without this, boxes would be drawn in their place.
    """
    return "".join(
        each if each.isascii() or each in _BEYOND_ASCII else "?"
        for each in normalize("NFKD", text)
        if not combining(each)
    )
