"""`bfsim check` in this process, and what it is tried on."""

from __future__ import annotations

import pytest
from click.testing import CliRunner, Result

from bfsim.cli.main import main
from bfsim.errors import BfsimError
from tests.eyes import FIRMWARE

SLOWER = FIRMWARE.replace(
    "        out[x] = 0\n",
    "        out[x] = 0\n        if x * 7919 // (line[x] + 1) == 123456:\n            found += 1\n",
)
WHAT = ("drive.mcap", "--firmware", "fw_eyes.py")


def call(*arguments: object) -> Result:
    """Call the command line in this process; unexpected exceptions come through."""
    return CliRunner().invoke(
        main, ["check", *map(str, arguments)], catch_exceptions=False, prog_name="bfsim"
    )


def refused(*arguments: object) -> str:
    """What is said of a mistake, in this process."""
    with pytest.raises(BfsimError) as caught:
        CliRunner().invoke(
            main, ["check", *map(str, arguments)], catch_exceptions=False, standalone_mode=False
        )
    return str(caught.value)
