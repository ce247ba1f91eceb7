"""What names and constants mean inside one kernel: parameters, locals seen so far, and what it can read from its module."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from difflib import get_close_matches

from bfsim.errors import shown, with_article
from bfsim.kernel.language import tree
from bfsim.kernel.language.constants import constant_of, members_of
from bfsim.kernel.language.refusal import KernelSource
from bfsim.kernel.types import BOOL, ArrayType, Value, f32, i32, u32

BEYOND_F32 = 3.4028235677973366e38
"""Numbers from here on are infinite in single precision; smaller ones are rounded to at most the largest."""


@dataclass(slots=True)
class Names:
    """The names of the function `kernel`.

    `outer`: what the names of the module mean. `own`: all names that are local to the function, wherever it assigns
    them.
    """

    source: KernelSource
    outer: Mapping[str, object]
    kernel: str
    own: tuple[str, ...]
    arrays: dict[str, ArrayType] = field(default_factory=dict)
    locals: dict[str, Value] = field(default_factory=dict)
    assigned: set[str] = field(default_factory=set)
    """Locals that hold a value on every path to the statement being read."""

    def is_builtin(self, node: ast.Name, function: object) -> bool:
        """Whether a name means this function of Python, and is not redefined by the kernel or the module."""
        return node.id not in self.own and self.outer.get(node.id) is function

    def _constant(self, node: ast.Constant) -> tree.Expr:
        if type(node.value) is bool:
            return self._truth(node, value=node.value)
        if type(node.value) is int:
            return replace(self._literal(node, node.value), written=self._hexadecimal(node))
        if type(node.value) is float:
            return self._real(node, node.value)
        is_letter = isinstance(node.value, str) and len(node.value) == 1
        instead = f"write its number, ord({node.value!r})" if is_letter else "use numbers"
        self.source.refuse(node, f"a kernel cannot use the constant {node.value!r}", instead)

    def _truth(self, node: ast.expr, *, value: bool, written: str = "") -> tree.Expr:
        one = tree.Const(int(value), i32, node.lineno, written)
        return tree.Compare("!=", one, tree.Const(0, i32, node.lineno), BOOL, node.lineno)

    def _hexadecimal(self, node: ast.Constant) -> str:
        """Return a hexadecimal number as written; '' for others."""
        written = self.source.text_of(node).replace("_", "")
        return written if re.fullmatch("0[xX][0-9a-fA-F]+", written) else ""

    def _literal(self, node: ast.expr, value: int) -> tree.Const:
        if not i32.bounds[0] <= value <= u32.bounds[1]:
            self.source.refuse(
                node, f"{shown(value)} does not fit in 32 bits", "use a value in -2147483648..4294967295"
            )
        return tree.Const(value, i32 if value <= i32.bounds[1] else u32, node.lineno)

    def _real(self, node: ast.expr, value: float, written: str = "") -> tree.Const:
        if math.isfinite(value) and abs(value) >= BEYOND_F32:
            self.source.refuse(
                node, f"{value} does not fit in an f32", "use a value in -3.4028e38..3.4028e38"
            )
        return tree.Const(f32(value), f32, node.lineno, written)

    def _name(self, node: ast.Name) -> tree.Expr:
        name = node.id
        if name in self.arrays:
            self.source.refuse(
                node, f"the array {name} is used like a number", f"write {name}[i] or len({name})"
            )
        if name in self.assigned:
            return tree.Local(name, self.locals[name], node.lineno)
        if name in self.own:
            of_module = f"; a kernel cannot change the {name} of the module" if name in self.outer else ""
            self.source.refuse(
                node,
                f"{name} may be used before it has a value",
                f"give {name} a value on every way to this line{of_module}",
            )
        constant = constant_of(self.outer.get(name))
        if constant is not None:
            return self._named(node, constant, name)
        self._require_defined(node)
        self.source.refuse(
            node,
            f"a kernel cannot read {name}, which is {with_article(type(self.outer[name]).__name__)}",
            "pass it as an array or integer parameter; of the module only constants that are an int, a float, a bool "
            "or of an IntEnum can be read",
        )

    def _require_defined(self, node: ast.Name) -> None:
        """Refuse a name that is not defined, and suggest the nearest ones."""
        if node.id not in (*self.own, *self.outer):
            near = get_close_matches(node.id, [*self.arrays, *self.own], n=2)
            instead = f"; near it are {', '.join(near)}" if near else ""
            self.source.refuse(
                node,
                f"the name {node.id} is not defined",
                f"assign it first, or make it a parameter{instead}",
            )

    def _named(self, node: ast.expr, constant: float, name: str) -> tree.Expr:
        """Read a constant of the module; `name`: what C calls it, if it has a name there."""
        if isinstance(constant, bool):
            return self._truth(node, value=constant, written=name)
        if isinstance(constant, float):
            return self._real(node, constant, written=name)
        return replace(self._literal(node, constant), written=name)

    def _attribute(self, node: ast.Attribute) -> tree.Expr:
        """Read a member of an enumeration of integers, `Mode.RUN`."""
        name = node.value.id if isinstance(node.value, ast.Name) else ""
        members = {} if name in self.own else members_of(self.outer.get(name))
        if node.attr in members:
            return self._literal(node, members[node.attr])
        if members:
            self.source.refuse(node, f"{name} has no member {node.attr}", f"it has {', '.join(members)}")
        if name in self.arrays:
            instead = f"write len({name}) for how many elements it has"
        else:
            instead = f"write {node.attr.upper()} = {ast.unparse(node)} in the module, if it is a number, and use that"
        self.source.refuse(node, "a kernel cannot use attributes", instead)
