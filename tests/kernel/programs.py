"""Random programs of the kernel language, as source text. They end; only careless ones index or divide wrongly."""

from __future__ import annotations

from hypothesis import strategies as st

ELEMENTS = 16
SIGNED, UNSIGNED = "i32", "u32"
ARGUMENTS = {
    "seed": st.integers(0, 1000),
    "x": st.integers(-(2**31), 2**31 - 1) | st.integers(-20, 20),
    "y": st.integers(0, 2**32 - 1) | st.integers(0, 20),
}
"""What to call a program with: the seed of what its arrays hold, and its numbers."""
ARRAYS = {"a": "u8", "b": "i8", "c": "u16", "d": "i16", "e": "u32", "f": "i32"}
LOCALS = {SIGNED: ("p", "q", "r"), UNSIGNED: ("v", "w")}
EDGES = {
    SIGNED: (0, 1, -1, 7, 255, -128, 32767, 65536, 2**31 - 1, -(2**31)),
    UNSIGNED: (0, 1, 200, 65535, 2**31, 2**32 - 1),
}
HEAD = """
@kernel
def mix(n: i32, row: u8[:]) -> i32:
    row[n & 15] = n
    return n * 3 - row[(n + 1) & 15]

@kernel
def program(a: u8[:], b: i8[:], c: u16[:], d: i16[:], e: u32[:], f: i32[:], x: i32, y: u32) -> {result}:
    p = i32(1)
    q = x
    r = x >> 3
    v = y
    w = u32(5)
    t = x > 3
"""


class Writer:
    """Draws a program piece by piece. `counters`: the loop names that may be read here."""

    def __init__(self, draw: st.DrawFn, *, careless: bool) -> None:
        self.draw = draw
        self.careless = careless
        self.rows: list[str] = []
        self.counters: list[str] = []
        self.names = 0

    def pick(self, *choices: str) -> str:
        """Draw one of `choices`."""
        return self.draw(st.sampled_from(choices))

    def literal(self, kind: str) -> str:
        """Write a number as a literal of `kind`."""
        value = self.draw(st.sampled_from(EDGES[kind]) | st.integers(0, 40))
        return f"{kind}({value})"

    def index(self, depth: int) -> str:
        """Write an index inside every array."""
        kind = self.pick(SIGNED, SIGNED, UNSIGNED)
        if self.is_careless():
            return self.value(kind, depth - 1)
        return f"{self.value(kind, depth - 1)} & {ELEMENTS - 1}"

    def is_careless(self) -> bool:
        """Draw whether the next index or divisor may be wrong."""
        return self.careless and self.draw(st.integers(0, 3)) == 0

    def leaf(self, kind: str) -> str:
        """Write an expression without operators."""
        names = [*LOCALS[kind], "x" if kind == SIGNED else "y", *(self.counters if kind == SIGNED else ())]
        return self.pick(*names, self.literal(kind))

    def value(self, kind: str, depth: int) -> str:
        """Write an expression of type `kind`."""
        if depth <= 0:
            return self.leaf(kind)
        form = self.draw(st.integers(0, 11))
        if form <= 3:
            return f"({self.value(kind, depth - 1)} {self.pick(*'+-*&|^')} {self.value(kind, depth - 1)})"
        if form == 4:
            dividend, divisor = self.value(kind, depth - 1), self.divisor(kind, depth - 1)
            operator = self.pick("//", "%", "quotient", "remainder")
            is_name = operator.isalpha()
            return f"{operator}({dividend}, {divisor})" if is_name else f"({dividend} {operator} {divisor})"
        if form == 5:
            amount = self.pick(f"({self.value(SIGNED, depth - 1)} & 31)", str(self.draw(st.integers(0, 31))))
            return f"({self.value(kind, depth - 1)} {self.pick('<<', '>>')} {amount})"
        if form == 6:
            return self.unary(kind, depth)
        if form == 7:
            return self.cast(kind, depth)
        if form == 8:
            yes, no = self.value(kind, depth - 1), self.value(kind, depth - 1)
            test = self.condition(depth - 1)
            operator, nothing = self.pick("+0", "-0", "|0", "^0", "&0", "*0", "*1", "? ")
            if operator == "?":
                return f"({yes} if {test} else {no})"
            return f"({no} {operator} ({yes} if {test} else {nothing}))"
        if form == 9:
            parts = [self.value(kind, depth - 1) for _ in range(self.draw(st.sampled_from((2, 2, 3))))]
            return f"{self.pick('min', 'max')}({', '.join(parts)})"
        array = self.pick(*("e" if kind == UNSIGNED else "abcdf"))
        return f"{array}[{self.index(depth)}]"

    def divisor(self, kind: str, depth: int) -> str:
        """Write a divisor, which is neither 0 nor -1 unless it is careless."""
        if self.is_careless():
            return self.value(kind, depth)
        positive = f"(({self.value(kind, depth)} & 63) + 2)"
        if kind == UNSIGNED:
            return self.pick(positive, "3", "16", "255")
        return self.pick(positive, f"(-{positive})", "3", "-7", "8", "-4", "1000")

    def unary(self, kind: str, depth: int) -> str:
        """Write - ~ or abs; only signed numbers have the last."""
        inner = self.value(kind, depth - 1)
        if kind == SIGNED and self.draw(st.booleans()):
            return f"abs({inner})"
        return f"({self.pick('-', '~')}{inner})"

    def cast(self, kind: str, depth: int) -> str:
        """Write a cast from either type."""
        inner = self.value(self.pick(SIGNED, UNSIGNED), depth - 1)
        to = UNSIGNED if kind == UNSIGNED else self.pick("u8", "i8", "u16", "i16", "i32")
        return f"{to}({inner})"

    def condition(self, depth: int) -> str:
        """Write what stands for a truth value where a branch is decided: that, or beside it an integer."""
        if self.draw(st.integers(0, 3)):
            return self.test(depth)
        number = self.value(self.pick(SIGNED, UNSIGNED), depth - 1)
        return f"{self.pick('', 'not ')}{number} {self.pick('and', 'or')} {self.test(depth - 1)}"

    def test(self, depth: int) -> str:
        """Write a truth value."""
        form = self.draw(st.integers(0, 6)) if depth > 0 else 0
        kind = self.pick(SIGNED, UNSIGNED)
        if form == 1:
            return f"({self.test(depth - 1)} {self.pick('and', 'or')} {self.test(depth - 1)})"
        if form == 2:
            return f"(not {self.test(depth - 1)})"
        if form == 3:
            parts = [self.value(kind, depth - 1) for _ in range(3)]
            return f"({parts[0]} {self.pick('<', '<=')} {parts[1]} {self.pick('<', '!=')} {parts[2]})"
        if form == 4:
            return "t"
        if form == 6:
            return f"({self.test(depth - 1)} {self.pick('==', '!=')} {self.test(depth - 1)})"
        operator = self.pick("<", "<=", ">", ">=", "==", "!=")
        return f"({self.value(kind, depth - 1)} {operator} {self.value(kind, depth - 1)})"

    def block(self, margin: str, depth: int, *, in_loop: bool) -> None:
        """Write one to four statements."""
        for _ in range(self.draw(st.integers(1, 4))):
            self.statement(margin, depth, in_loop=in_loop)

    def statement(self, margin: str, depth: int, *, in_loop: bool) -> None:
        """Write one statement; compound ones only while `depth` lasts."""
        form = self.draw(st.integers(0, 11 if depth > 0 else 7))
        kind = self.pick(SIGNED, UNSIGNED)
        if form <= 1:
            self.rows.append(f"{margin}{self.pick(*LOCALS[kind])} = {self.value(kind, 3)}")
        elif form == 2:
            self.rows.append(
                f"{margin}{self.pick(*LOCALS[kind])} {self.pick('+', '-', '*', '^')}= {self.value(kind, 2)}"
            )
        elif form == 3:
            array = self.pick(*ARRAYS)
            kind = UNSIGNED if array == "e" else SIGNED
            self.rows.append(
                f"{margin}{array}[{self.index(2)}] {self.pick('', '+', '|')}= {self.value(kind, 3)}"
            )
        elif form == 4:
            call = f"mix({self.value(SIGNED, 1)}, a)"
            sides = [call, self.value(SIGNED, 1)]
            left, right = sides if self.draw(st.booleans()) else sides[::-1]
            self.rows.append(f"{margin}{self.pick(*LOCALS[SIGNED])} = {left} + {right}")
        elif form == 5:
            self.rows.append(f"{margin}t = {self.test(2)}")
        elif form <= 7:
            self.several(margin, kind, alike=form == 6)
        elif form <= 9:
            self.branch(margin, depth, in_loop=in_loop)
        else:
            self.loop(margin, depth)

    def several(self, margin: str, kind: str, *, alike: bool) -> None:
        """Write an assignment to two or three targets: of one value to all, or of as many.

        No target is there twice: CPython up to 3.11.2 gives `q, q = 1, 2` the 1.
        """
        array = f"{self.pick(*('e' if kind == UNSIGNED else 'abcdf'))}[{self.index(1)}]"
        some = st.lists(st.sampled_from((*LOCALS[kind], array)), min_size=2, max_size=3, unique=True)
        targets = self.draw(some)
        calls = [f"mix({self.value(SIGNED, 1)}, a)"] if kind == SIGNED else []
        values = [self.pick(self.value(kind, 2), *targets, *calls) for _ in targets]
        left, right = (" = ".join(targets), values[0]) if alike else (", ".join(targets), ", ".join(values))
        self.rows.append(f"{margin}{left} = {right}")

    def branch(self, margin: str, depth: int, *, in_loop: bool) -> None:
        """Write an if, with elif and else at times; in a loop it may jump."""
        self.rows.append(f"{margin}if {self.condition(2)}:")
        jump = self.draw(st.integers(0, 3))
        if jump == 0 and in_loop:
            self.rows.append(f"{margin}    {self.pick('break', 'continue')}")
            return
        self.block(margin + "    ", depth - 1, in_loop=in_loop)
        for head in (f"elif {self.condition(2)}:", "else:")[self.draw(st.integers(0, 1)) :]:
            if self.draw(st.booleans()):
                self.rows.append(f"{margin}{head}")
                self.block(margin + "    ", depth - 1, in_loop=in_loop)

    def loop(self, margin: str, depth: int) -> None:
        """Write a loop that surely ends: over a range or an array, or bounded by a counter of its own."""
        name = f"k{self.names}"
        self.names += 1
        form = self.draw(st.integers(0, 5))
        if form == 4:
            self.rows.append(f"{margin}for {name} in {self.pick(*'abcdf')}:")
        elif form == 5:
            target = self.pick(*LOCALS[SIGNED], f"d[{name} & 15]")
            self.rows.append(f"{margin}for {name}, {target} in enumerate({self.pick(*'abcdf')}):")
        elif form <= 1:
            start, stop = self.draw(st.integers(-3, 9)), f"{self.value(SIGNED, 1)} & 15"
            step = self.pick("1", "1", "2", "3", "-1", "-2", f"({self.value(SIGNED, 1)} & 3) + 1")
            self.rows.append(f"{margin}for {name} in range({start}, {stop}, {step}):")
        else:
            self.rows.append(f"{margin}{name} = i32(0)")
            self.rows.append(
                f"{margin}while {name} < {self.draw(st.integers(0, 9))} and ({self.condition(1)}):"
            )
            self.rows.append(f"{margin}    {name} += 1")
        self.counters.append(name)
        self.block(margin + "    ", depth - 1, in_loop=True)
        self.counters.pop()


@st.composite
def programs(draw: st.DrawFn, *, careless: bool = False) -> str:
    """Draw the text of a module with the kernels `mix` and `program`."""
    writer = Writer(draw, careless=careless)
    result = writer.pick(SIGNED, UNSIGNED)
    for _ in range(draw(st.integers(2, 6))):
        writer.statement("    ", 2, in_loop=False)
    writer.rows.append(f"    return {writer.value(result, 2)}")
    return HEAD.format(result=result) + "\n".join(writer.rows) + "\n"
