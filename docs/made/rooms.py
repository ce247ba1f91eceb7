"""The rooms of bfsim as a picture: one row a floor, the lowest imports nothing; the main ones of `tests/rooms.py`."""

from __future__ import annotations

from html import escape

FLOORS = (
    (
        ("errors", "what goes wrong"),
        ("files", "the cache"),
        ("clocks", "ticks"),
        ("trace", "records"),
        ("seen", "what a frame showed"),
    ),
    (("spans", "the timeline"), ("chip", "data: boards"), ("blackfin", "instructions → native code")),
    (("kernel", "Python → code and cost"), ("linker", "LDF → placement"), ("recording", "frames in and out")),
    (("compiling", "C → object code"), ("machine", "the devices; has SimPy"), ("report", "records → tables")),
    (
        ("api", "all that firmware imports"),
        ("loading", "firmware by name"),
        ("running", "what a run is made of"),
    ),
    (("run", "recording + firmware + board + LDF → records"), ("result", "a run with reports")),
    (
        ("explain", "a kernel line by line"),
        ("assembly", "its instructions"),
        ("verifying", "beside the real compiler"),
    ),
    (("sweeping", "many runs"), ("placing", "the best LDF"), ("checking", "a budget of cycles")),
    (("cli", "commands: parse, call, print"),),
)
WIDTH, HEIGHT, GAP = 760, 46, 12
STYLE = (
    "text{font:600 14px sans-serif;fill:#16324f}tspan{font-weight:400;fill:#48627c}"
    "rect{fill:#e8f0f8;stroke:#5b85ad;rx:6px}.out rect{fill:#fdf3e1;stroke:#c98d2b}"
)


def _room(x: float, y: float, width: float, name: str, what: str) -> str:
    """Draw one room with its name and what it is for."""
    return (
        f'<rect x="{x:.0f}" y="{y}" width="{width:.0f}" height="{HEIGHT}"/>'
        f'<text x="{x + 10:.0f}" y="{y + 28}">{escape(name)} <tspan>{escape(what)}</tspan></text>'
    )


def _floor(rooms: tuple[tuple[str, str], ...], y: float) -> list[str]:
    """Draw rooms side by side, as wide as their words are long."""
    lengths = [len(name) + len(what) for name, what in rooms]
    free = WIDTH - GAP * (len(rooms) + 1)
    drawn, x = [], float(GAP)
    for (name, what), length in zip(rooms, lengths, strict=True):
        width = free * length / sum(lengths)
        drawn.append(_room(x, y, width, name, what))
        x += width + GAP
    return drawn


def drawing() -> str:
    """Return the picture as SVG."""
    height = (HEIGHT + GAP) * (len(FLOORS) + 1) + GAP
    parts = [
        part
        for number, floor in enumerate(reversed(FLOORS), start=1)
        for part in _floor(floor, GAP + (HEIGHT + GAP) * number)
    ]
    outside = _room(
        GAP, GAP, WIDTH - 2 * GAP, "firmware/", "stands outside: it imports api, and nothing imports it"
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img" '
        f'aria-label="The rooms of bfsim, from the commands at the top to errors and clocks at the bottom">'
        f'<style>{STYLE}</style>{"".join(parts)}<g class="out">{outside}</g></svg>\n'
    )
