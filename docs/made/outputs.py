"""Put what commands print now into the pages: `python docs/made/outputs.py [PAGE ...]` after a change of cycles or words.

Pages are played as the tests play them. As many lines of an output are shown above a line `...` as before; to show some for the
first time, write a line of anything for each.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent.parent))

from tests.pages import PAGES, Reader, blocks_of, reader


def main() -> None:
    """Refresh the pages that are named, or all."""
    for page in [Path(each).resolve() for each in sys.argv[1:]] or PAGES:
        with reader() as somebody:
            refreshed = _refreshed(page, somebody)
        if refreshed != page.read_text():
            page.write_text(refreshed)


def _refreshed(page: Path, somebody: Reader) -> str:
    text = page.read_text()
    at = 0
    for block in blocks_of(page):
        if block.runner:
            continue
        for command, printed, output in somebody.play(block):
            at = text.index(f"$ {command}\n", at)
            if "..." in printed:
                above = printed[: printed.index("...")]
                begin = text.index("\n", at) + 1
                end = begin + sum(len(line) + 1 for line in above)
                text = text[:begin] + _first_lines(output, sum(map(bool, above))) + text[end:]
            at += 1
    return text


def _first_lines(output: str, count: int) -> str:
    """Return the lines of an output up to the one that is the `count`th with anything in it."""
    shown: list[str] = []
    lines = iter(output.splitlines())
    while count:
        shown.append(next(lines).rstrip())
        count -= bool(shown[-1])
    return "".join(f"{line}\n" for line in shown)


if __name__ == "__main__":
    main()
