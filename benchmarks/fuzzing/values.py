"""Values that programs stumble over, and how text and trees of values are made wrong with them."""

from __future__ import annotations

import re
from random import Random
from typing import Any

WORDS = (
    "", "0", "-1", "1", "65536", "4294967296", "9" * 400, "9" * 5000, "0x", "0xFFFFFFFFFFFFFFFF", "1e999", "nan", "-inf",
    "x", "é", "\udcff", "\u202e", "\x1b[2J", "a b", "a\nb", "'", '"', "\\", "%s", "{}", "..", "/", "/dev/null", "/dev/full",
    "\n\n\n", "tinyphoon", "cm-bf561", "a" * 300, "a" * 40_000, "(" * 3000, "*" * 50, "--", "-", "@", "#",
)  # fmt: skip
NUMBERS = (0, 1, -1, 7, 255, 256, 65535, 65536, -32769, 2**31, 2**32, 2**63, 2**64, 10**40, 1.5, -0.0, 1e308)
_TOKEN = re.compile(r"\w+|\s+|[^\w\s]")


def any_value(random: Random, depth: int = 0) -> Any:
    """Return a value of any type, of those that JSON has."""
    kind = random.randrange(6 if depth < 3 else 4)
    if kind == 0:
        return random.choice(WORDS).encode(errors="replace").decode()
    if kind == 1:
        return random.choice(NUMBERS)
    if kind in (2, 3):
        return random.choice((None, True, False, "mode", "x"))
    if kind == 4:
        return [any_value(random, depth + 1) for _ in range(random.randrange(4))]
    return {
        random.choice(("a", "send", "", "é")): any_value(random, depth + 1)
        for _ in range(random.randrange(4))
    }


def changed_tree(random: Random, tree: Any) -> Any:
    """Return a tree of values with one of its parts replaced, left out, renamed or given twice."""
    if isinstance(tree, dict) and tree and random.random() < 0.8:
        key = random.choice(list(tree))
        rest = {name: value for name, value in tree.items() if name != key}
        match random.randrange(6):
            case 0:
                return rest
            case 1:
                return {**rest, random.choice(("x", key + "_", key.upper(), "")): tree[key]}
            case 2:
                return {**tree, random.choice(("x", "words", "bytes", "type")): any_value(random)}
        return {**tree, key: changed_tree(random, tree[key])}
    if isinstance(tree, list) and tree and random.random() < 0.8:
        place = random.randrange(len(tree))
        match random.randrange(4):
            case 0:
                return tree[:place] + tree[place + 1 :]
            case 1:
                return tree * random.choice((2, 50))
        return [*tree[:place], changed_tree(random, tree[place]), *tree[place + 1 :]]
    return any_value(random)


def changed_text(random: Random, text: str) -> str:
    """Return a text with some of its tokens left out, doubled, exchanged or replaced."""
    tokens = _TOKEN.findall(text)
    for _ in range(random.choice((1, 1, 2, 5))):
        if not tokens:
            break
        place, other = random.randrange(len(tokens)), random.randrange(len(tokens))
        match random.randrange(6):
            case 0:
                del tokens[place]
            case 1:
                tokens.insert(place, tokens[other])
            case 2:
                tokens[place], tokens[other] = tokens[other], tokens[place]
            case 3:
                tokens[place] = random.choice(WORDS)
            case 4:
                tokens[place:] = tokens[place:][: random.randrange(50)]
            case 5:
                first, last = sorted((place, other))
                tokens[first:last] = tokens[first:last][:200] * random.choice((2, 3))
    return "".join(tokens)


def changed_bytes(random: Random, data: bytes) -> bytes:
    """Return bytes with some of them flipped, cut out, doubled, or set to the largest number."""
    made = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 8))):
        if not made:
            break
        place = random.randrange(len(made))
        match random.randrange(5):
            case 0:
                made[place] ^= 1 << random.randrange(8)
            case 1:
                made[place : place + 8] = random.choice((b"\xff" * 8, bytes(8), bytes(7) + b"\x80"))
            case 2:
                del made[place : place + random.choice((1, 4, 100))]
            case 3:
                made[place:place] = made[place : place + random.choice((1, 9, 100))]
            case 4:
                del made[place:]
    return bytes(made)
