"""Where C declares the locals of a kernel: as far inside as they are used, with their first value if possible."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from bfsim.kernel.language import tree
from bfsim.kernel.language.function import Function

Block = tuple[tree.Stmt, ...]


@dataclass(slots=True)
class Declarations:
    """`with_value`: assignments that declare what they assign. `before`: names declared alone, by statement.

    `counting`: loops whose own name counts the iterations. In Python a loop's name keeps its last value after the loop,
    and may be assigned inside without any effect on the iterations; a loop that needs this counts with a name that only
    C has. Statements are told apart by identity: a kernel may have two equal ones.
    """

    with_value: set[int] = field(default_factory=set)
    before: dict[int, list[str]] = field(default_factory=dict)
    counting: set[int] = field(default_factory=set)


def declarations(function: Function) -> Declarations:
    """Return where the locals of a kernel are declared."""
    parameters = {each.name for each in function.parameters}
    found, body = Declarations(), tree.body_of(function)
    found.counting.update(map(id, _counting_loops(body.block, (), parameters)))
    for name in (name for name, _ in body.locals if name not in parameters):
        _Local(name, found).declare(body.block)
    return found


Place = tuple[tuple[Block, int], ...]
"""Where a statement stands: the blocks around it, the innermost last, and its position in each."""


def _counting_loops(block: Block, outside: Place, parameters: set[str]) -> Iterator[tree.For]:
    """Yield the loops in `block` that assign their name nowhere else, and after which its value is not read."""
    for position, node in enumerate(block):
        place = (*outside, (block, position))
        if (
            isinstance(node, tree.For)
            and node.name not in parameters
            and not _assigns(node.body, node.name)
            and _is_dead_behind(node.name, place)
        ):
            yield node
        for inner in _blocks(node):
            yield from _counting_loops(inner, place, parameters)


def _assigns(block: Block, name: str) -> bool:
    return any(isinstance(each, (tree.Assign, tree.For)) and each.name == name for each in tree.parts(block))


def _is_dead_behind(name: str, place: Place) -> bool:
    """Whether no path from after the statement at `place` reads `name` before it is assigned."""
    block, position = place[-1]
    dead = _first_use(name, block[position + 1 :])
    if dead is not None or len(place) == 1:
        return dead is not False
    outer, outer_position = place[-2]
    around = outer[outer_position]
    if isinstance(around, (tree.While, tree.For)):
        again = _first_use(name, block[:position])
        if again is False or (isinstance(around, tree.While) and _uses(around.test, name)):
            return False
    return _is_dead_behind(name, place[:-1])


def _first_use(name: str, block: Block) -> bool | None:
    """Whether the first statement of `block` that has to do with `name` assigns it; None if there is none.

    Loops over `name` neither need its value nor are sure to change it: they may have no iteration.
    """
    first = next((each for each in block if _needs(each, name)), None)
    if first is None:
        return None
    return isinstance(first, tree.Assign) and first.name == name and not _uses(first.value, name)


def _needs(node: tree.Stmt, name: str) -> bool:
    """Whether a statement has to do with `name` other than by loops over it."""
    if isinstance(node, tree.For) and node.name == name:
        return _in_head(node, name)
    inner = [each for block in _blocks(node) for each in block]
    return _in_head(node, name) or any(_needs(each, name) for each in inner) if inner else _uses(node, name)


def _uses(node: object, name: str) -> bool:
    return any(
        isinstance(each, (tree.Local, tree.Assign, tree.For)) and each.name == name
        for each in tree.parts(node)
    )


def _blocks(node: tree.Stmt) -> Iterator[Block]:
    if isinstance(node, (tree.While, tree.For)):
        yield node.body
    elif isinstance(node, tree.If):
        yield node.body
        yield node.orelse


def _in_head(node: tree.Stmt, name: str) -> bool:
    """Whether what a statement evaluates before its blocks reads `name`."""
    if isinstance(node, tree.For):
        return any(_uses(each, name) for each in (node.start, node.stop, node.step))
    return isinstance(node, (tree.If, tree.While)) and _uses(node.test, name)


@dataclass(frozen=True, slots=True)
class _Local:
    """Declares one local; loops that count with its name declare that name themselves."""

    name: str
    found: Declarations

    def declare(self, block: Block) -> None:
        """Declare it in `block`, or further inside."""
        users = [each for each in block if self._needed_in(each)]
        if not users:
            return
        first = users[0]
        if isinstance(first, tree.Assign) and first.name == self.name and not _uses(first.value, self.name):
            self.found.with_value.add(id(first))
            return
        inner = [each for each in _blocks(first) if any(map(self._needed_in, each))]
        takes_it = isinstance(first, tree.For) and first.name == self.name
        if len(users) == len(inner) == 1 and not takes_it and not _in_head(first, self.name):
            self.declare(inner[0])
        else:
            self.found.before.setdefault(id(first), []).append(self.name)

    def _needed_in(self, node: tree.Stmt) -> bool:
        if id(node) in self.found.counting and isinstance(node, tree.For) and node.name == self.name:
            return _in_head(node, self.name)
        inner = [each for block in _blocks(node) for each in block]
        if inner:
            takes_it = isinstance(node, tree.For) and node.name == self.name
            return takes_it or _in_head(node, self.name) or any(map(self._needed_in, inner))
        return _uses(node, self.name)
