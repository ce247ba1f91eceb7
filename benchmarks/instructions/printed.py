"""Every form of instruction as GNU objdump prints it.

    python -m benchmarks.instructions.printed tests/blackfin/data/text.json       records one encoding of each form
    python -m benchmarks.instructions.printed libgcc.a libc.a                      compares all instructions in archives

Needs bfin-elf-objdump on PATH. Symbols and comments are left out: objdump's comments say what registers hold, by its
own guess. Loops that begin 16 bytes behind LSETUP or more, or end 1,024 behind it or more, are not among those
recorded: objdump prints them as lying before it.
"""

from __future__ import annotations

import argparse
import json
import random
import re
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks.instructions.memory_sequences import encoded
from bfsim.blackfin.instructions.decode import InstructionError, decode
from bfsim.blackfin.instructions.form import Form
from bfsim.blackfin.instructions.forms import TABLE
from bfsim.blackfin.instructions.text import text

ADDRESS = 0x1000
ROW = re.compile(r"\s*([0-9a-f]+):\t([0-9a-f ]+?)\s*\t(.*)")
ADDED = re.compile(r";?\s*/\*(?! unused).*?\*/| <[^>]*>|;.*|0x(?=0x)|(?<=0x)0+(?=[0-9a-f])")
"""Comments, symbols, the semicolon at the end, zeros before an address, its 0x where it has no symbol."""


def printed(*arguments: str | Path) -> Iterator[tuple[int, bytes, str]]:
    """Yield the address, bytes and text of each instruction that objdump finds."""
    said = subprocess.run(
        ["bfin-elf-objdump", "-w", *arguments], check=True, capture_output=True, text=True
    ).stdout
    for line in said.splitlines():
        if found := ROW.match(line):
            yield int(found[1], 16), bytes.fromhex(found[2]), plain(found[3])


def plain(line: str) -> str:
    """Return a line of objdump without what it adds."""
    return ADDED.sub("", line).strip()


def example(form: Form, chance: random.Random) -> bytes:
    """Return bytes that are of this form."""
    for _ in range(10_000):
        fields = {each: chance.getrandbits(len(places)) for each, places in form.fields.items()}
        if form.does == "loop_setup":
            fields["s"], fields["e"] = fields["s"] % 8, fields["e"] % 512
        code = encoded(form, **fields)
        try:
            found = decode(code + bytes(4), ADDRESS)
        except InstructionError:
            continue
        if found.operations[0].form is form:
            return code
    raise SystemExit(f"no encoding of {form.text} is decoded as one")


def record(path: Path) -> None:
    """Write bytes and objdump's text of one instruction of each form."""
    chance = random.Random(1)
    codes = [example(each, chance) for each in TABLE]
    with tempfile.NamedTemporaryFile() as file:
        file.write(b"".join(codes))
        file.flush()
        options = ("-D", "-b", "binary", "-m", "bfin", f"--adjust-vma={ADDRESS:#x}", file.name)
        texts = {address: (octets, line) for address, octets, line in printed(*options)}
    rows, address = [], ADDRESS
    for code in codes:
        octets, line = texts[address]
        assert octets == code, (octets, code)
        rows.append(json.dumps([address, code.hex(), line]))
        address += len(code)
    path.write_text("[\n" + ",\n".join(rows) + "\n]\n")


def compare(path: Path) -> None:
    """Print what is printed otherwise in an archive, and how much is in it."""
    number = 0
    for address, octets, line in printed("-d", path):
        number += 1
        try:
            ours = plain(text(decode(octets, address)))
        except InstructionError as refused:
            ours = str(refused)
        if ours != line:
            print(f"{octets.hex()}: {line!r} here is {ours!r}")
    print(f"{path.name}: {number:,} instructions")


def main() -> None:
    """Record or compare each file."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE", help="*.json to record, or an archive")
    for each in parser.parse_args().files:
        record(each) if each.suffix == ".json" else compare(each)


if __name__ == "__main__":
    main()
