"""A `continue` that makes two loops of one: the statements before it become an inner loop.

[find_subloop_latch_edge_by_ivs in cfgloop.cc of GCC 12] The way back of the inner loop comes before all others, and
every other way back hands on other values of the variables that it hands on. LLVM splits loops by a rule of its own, so
a loop that GCC does not split is given one way back.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from bfsim.kernel.language import tree

MEMORY = "*"
"""Stands for all arrays among the names of variables."""


def makes_subloop(loop: tree.While, function: Sequence[tree.Stmt]) -> bool:
    """Whether GCC makes two loops of one in the body of `function`, by the first `continue` of `loop`."""
    before: dict[str, bool] = {}
    for number, each in enumerate(loop.body):
        if _is_bare(each):
            kept = {name for name, is_constant in before.items() if not is_constant}
            handed_on = {name for name in kept if _is_carried(name, loop, function)}
            ways = _ways_back(loop.body[number + 1 :], frozenset(), to_next=True)
            return all(handed_on <= changed for changed in ways)
        if _continues(each):
            return False  # its way back does not come before the others
        before |= dict.fromkeys(_changed(each), False)
        if isinstance(each, tree.Assign):
            before[each.name] = isinstance(each.value, tree.Const)
    return False


def end_of_subloop(loop: tree.While, function: Sequence[tree.Stmt]) -> tuple[tree.If, bool] | None:
    """Return the test at which GCC makes two loops of `loop`, and whether the inner one is left where it holds.

    The test ends an iteration: in `if a[m] > x: high = m`, `else: low = m + 1`, a side that only sets variables for the next
    iteration leads back at once. The inner loop begins with the test of both, so neither is rotated. If the test is that of
    `loop` itself, that side leads out of it.
    """
    before, last = loop.body[:-1], loop.body[-1] if loop.body else None
    if not isinstance(last, tree.If) or any(map(_continues, loop.body)) or tree.alike(last.test, loop.test):
        return None
    changed = {name for each in before for name in _changed(each)}
    for side, other in ((last.orelse, last.body), (last.body, last.orelse)):
        handed_on = {name for name in changed - _changed(side) if _is_carried(name, loop, function)}
        ways = [*_ways_back(other, frozenset(), to_next=True)]
        if _only_chooses(side) and other and ways and all(handed_on <= each for each in ways):
            return last, other is last.body
    return None


def _only_chooses(side: Sequence[tree.Stmt]) -> bool:
    """Whether statements only set variables to others, or to numbers."""
    return all(
        isinstance(each, tree.Assign) and isinstance(each.value, (tree.Local, tree.Const)) for each in side
    )


def _is_bare(statement: tree.Stmt) -> bool:
    """Whether it is `if test: continue` and nothing else."""
    return (
        isinstance(statement, tree.If)
        and not statement.orelse
        and [*map(type, statement.body)] == [tree.Continue]
    )


def _ways_back(
    body: Sequence[tree.Stmt], changed: frozenset[str], *, to_next: bool
) -> Iterator[frozenset[str]]:
    """Yield the variables changed on each path from here to the next iteration; `changed` are changed already.

    `to_next`: whether the end of `body` leads there.
    """
    for number, each in enumerate(body):
        if isinstance(each, tree.Continue):
            yield changed
        if isinstance(each, (tree.Continue, tree.Break, tree.Return)):
            return
        if isinstance(each, tree.If):
            ends = to_next and number == len(body) - 1
            for side in (each.body, each.orelse):
                yield from _ways_back(side, changed, to_next=ends)
            if ends:
                return
        changed |= _changed(each)
    if to_next:
        yield changed


def _is_carried(name: str, loop: tree.While, function: Sequence[tree.Stmt]) -> bool:
    """Whether a later iteration, or the code after the loop, reads what an iteration left in a variable."""
    if name == MEMORY:
        return True
    behind = (each for each in _behind(loop, function) if _is_use(each, name))
    return _is_read_first((loop.test, *loop.body), name) or _is_read_first(behind, name)


def _behind(loop: tree.While, function: Sequence[tree.Stmt]) -> Iterator[object]:
    """Yield the parts of a function after a loop, in source order."""
    inside = {id(each) for each in tree.parts(loop)}
    parts = iter(tree.parts(tuple(function)))
    for each in parts:
        if each is loop:
            break
    yield from (each for each in parts if id(each) not in inside)


def _is_use(node: object, name: str) -> bool:
    return isinstance(node, (tree.Local, tree.Assign, tree.For)) and node.name == name


def _is_read_first(nodes: Iterable[object], name: str) -> bool:
    """Whether a variable is read before one of `nodes` itself assigns to it."""
    for each in nodes:
        read = each.value if isinstance(each, tree.Assign) else each
        if any(isinstance(part, tree.Local) and part.name == name for part in tree.parts(read)):
            return True
        if isinstance(each, tree.Assign) and each.name == name:
            return False
    return False


def _changed(node: object) -> frozenset[str]:
    """Return the variables that statements assign to."""
    names = set()
    for each in tree.parts(node):
        if isinstance(each, (tree.Assign, tree.For)):
            names.add(each.name)
        elif isinstance(each, tree.Store) or (isinstance(each, tree.KernelCall) and each.callee.written):
            names.add(MEMORY)
    return frozenset(names)


def _continues(statement: tree.Stmt) -> bool:
    """Whether a statement has a `continue` of the loop that it stands in."""
    if isinstance(statement, tree.If):
        return any(map(_continues, (*statement.body, *statement.orelse)))
    return isinstance(statement, tree.Continue)
