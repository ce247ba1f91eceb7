"""Where the pointers of a routine point: into which array, and how far from its first element.

Every pointer into an array gets companions, written into the text of the IR after it: the array, its length, and the
distance in bytes. They are joined where pointers are joined. The IR has 32-bit pointers, so that LLVM may add up
distances in any order; on the host they have 64 bits and never wrap.
Added names begin with a dot, which a name of the kernel cannot do.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

NAME = r"%[\w.$-]+"
TABLE = r"@[\w.$-]+"
"""Name of a compiler's own table of constants."""
ELEMENT_ADDRESS = re.compile(
    rf"^  ({NAME}) = getelementptr (?:(?:inbounds|nuw|nusw|nsw) )*([^%@]+), ptr ({NAME}|{TABLE}), (.+?)(?:, !.*)?$"
)
INDEX = re.compile(r"(i\d+) ([^,\s]+)")
JOIN = re.compile(
    rf"^  ({NAME}) = (?:phi ptr (?P<arms>.+?)|select (?P<test>i1 [^,]+), (?P<sides>ptr .+?))(?:, !.*)?$"
)
ARM = re.compile(rf"\[ ([^,\]]+), ({NAME}) \]")
SIDE = re.compile(r"ptr ([^,\s]+)")
LOCAL = re.compile(rf"^  ({NAME}) = alloca ")
VECTOR = re.compile(r"\[(\d+) x (.+)\]")
FLOAT_BYTES = 4


@dataclass(frozen=True, slots=True)
class Origin:
    """What a pointer points to: the texts of an array (`ptr`), its length (`i32`) and the distance in bytes (`i64`)."""

    array: str
    length: str
    distance: str


class Pointers:
    """The pointers of one routine, whose text is `parameters` and `rows`."""

    def __init__(self, parameters: str, rows: Sequence[str]) -> None:
        names = [each.split()[-1] for each in parameters.split(", ") if each]
        self._arrays = {each for each in names if f"{each}.len" in names}
        self._moved: dict[str, str] = {}
        """For a pointer that is another one moved, the other one."""
        self._joined: dict[str, list[str]] = {}
        """For a pointer that is one of several, all of them."""
        self._locals: set[str] = set()
        for row in rows:
            if found := ELEMENT_ADDRESS.match(row):
                self._moved[found[1]] = found[3]
            elif found := JOIN.match(row):
                self._joined[found[1]] = [each for each, _ in _arms(found)]
            elif found := LOCAL.match(row):
                self._locals.add(found[1])

    def is_local(self, pointer: str) -> bool:
        """Whether `pointer` points to a local of the routine or into a compiler's own table, not into an array."""
        while pointer in self._moved:
            pointer = self._moved[pointer]
        return pointer in self._locals or pointer.startswith("@")

    def origin(self, pointer: str) -> Origin:
        """Return what `pointer` points to, in terms of the companions."""
        name = pointer[1:]
        if pointer in self._arrays:
            return Origin(pointer, f"{pointer}.len", "0")
        if pointer in self._moved:
            whole = self.origin(self._moved[pointer])
            return Origin(whole.array, whole.length, f"%.distance.{name}")
        if pointer in self._joined:
            return Origin(f"%.array.{name}", f"%.length.{name}", f"%.distance.{name}")
        if not pointer.startswith("%"):  # LLVM knows that it is never used
            return Origin(pointer, "0", "0")
        raise AssertionError(f"nobody knows where {pointer} points")

    def array(self, pointer: str) -> str | None:
        """Return the name of the array parameter that `pointer` points into; None if it may be one of several."""
        found = self.origin(pointer).array
        return found[1:] if found in self._arrays else None

    def companions(self, row: str) -> Iterator[str]:
        """Yield the rows after `row` that compute where its pointer points; none if it has no pointer into an array."""
        if (found := ELEMENT_ADDRESS.match(row)) and not self.is_local(found[3]):
            yield from self._distance(found)
        elif found := JOIN.match(row):
            yield from self._join(found)

    def _join(self, found: re.Match[str]) -> Iterator[str]:
        arms = [(self.origin(pointer), label) for pointer, label in _arms(found)]
        for what, kind in (("array", "ptr"), ("length", "i32"), ("distance", "i64")):
            values = [(getattr(origin, what), label) for origin, label in arms]
            if found["test"]:
                text = f"select {found['test']}, " + ", ".join(f"{kind} {value}" for value, _ in values)
            else:
                text = f"phi {kind} " + ", ".join(f"[ {value}, {label} ]" for value, label in values)
            yield f"  %.{what}.{found[1][1:]} = {text}"

    def _distance(self, found: re.Match[str]) -> Iterator[str]:
        """Add up the bytes of each index."""
        total, kind, result = self.origin(found[3]).distance, found[2], f"%.distance.{found[1][1:]}"
        indexes = INDEX.findall(found[4])
        for step, (width, index) in enumerate(indexes):
            if step:
                inner = VECTOR.fullmatch(kind)
                assert inner
                kind = inner[2]
            after = result if step == len(indexes) - 1 else f"{result}.{step}"
            yield f"  {after}.index = sext {width} {index} to i64"
            yield f"  {after}.bytes = mul nsw i64 {after}.index, {nbytes_of(kind)}"
            yield f"  {after} = add nsw i64 {total}, {after}.bytes"
            total = after


def nbytes_of(kind: str) -> int:
    """Return the size of a type of the IR in bytes: an integer, a float, or a vector of these."""
    if found := VECTOR.fullmatch(kind):
        return int(found[1]) * nbytes_of(found[2])
    return FLOAT_BYTES if kind == "float" else int(kind[1:]) // 8


def _arms(join: re.Match[str]) -> list[tuple[str, str]]:
    """Return (pointer, label of the block that it comes from) for each arm of a join; a select has no labels."""
    if join["arms"]:
        return ARM.findall(join["arms"])
    return [(each, "") for each in SIDE.findall(join["sides"])]
