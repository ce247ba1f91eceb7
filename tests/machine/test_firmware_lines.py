"""Messages name the firmware's own line, whatever library it was in."""

import json
from pathlib import Path

import numpy as np
import pytest
from numba import njit

from bfsim.machine.firmware_lines import NOT_FIRMWARE, line_of


def test_an_error_inside_a_library_is_the_firmwares_line() -> None:
    """What json raises is told with the line that called it."""
    with pytest.raises(json.JSONDecodeError) as raised:
        json.loads("{")
    assert line_of(raised.value).startswith(f" ({__file__}:")


def test_an_error_inside_an_installed_package_is_the_firmwares_line() -> None:
    """It was told with a line of numba, or of whatever library firmware had asked in vain."""
    with pytest.raises(TypeError) as raised:
        njit(3)
    assert line_of(raised.value).startswith(f" ({__file__}:")


def test_installed_firmware_is_firmware() -> None:
    """Python's own library, numpy and bfsim are not the firmware; what pip installs beside them may be."""
    library = Path(json.__file__).parent.parent
    for path in (
        json.__file__,
        np.__file__,
        "<frozen importlib._bootstrap>",
        "<string>",
        library / "pathlib.py",
    ):
        assert NOT_FIRMWARE.match(str(path))
    for path in (library / "site-packages" / "eyes.py", Path(__file__), Path("firmware/core_a.py")):
        assert not NOT_FIRMWARE.match(str(path))
