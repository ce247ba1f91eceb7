"""Import a module that a user named, and what it imports: once, unless one of its sources has changed."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

from bfsim import shipped
from bfsim.errors import BfsimError, FirmwareError, cut, is_failure, pointed, printable, shown
from bfsim.loading.importing import OwnModules, Root
from bfsim.loading.kernels import add_files_of_code, kernels_of
from bfsim.loading.libraries import add_libraries
from bfsim.machine.firmware_lines import failure_of, line_of

SHIPPED = Root(shipped.FIRMWARE_FOLDER, shipped.FIRMWARE_PACKAGE)

_imported: dict[tuple[str, Root], tuple[ModuleType, OwnModules]] = {}


def import_own(module: str, root: Root) -> tuple[ModuleType, OwnModules]:
    """Import a module from `root`, and the shipped firmware that it imports.

    Raises FirmwareError when that fails.
    """
    known = _imported.get((module, root))
    if known and not known[1].changed:
        return known
    own = OwnModules((root, SHIPPED))
    imported = import_more(module, own)
    add_libraries(own.sources, SHIPPED.folder)
    add_files_of_code(own, kernels_of(own))
    _imported[module, root] = imported, own
    return imported, own


def import_more(module: str, own: OwnModules) -> ModuleType:
    """Import a module as one of a firmware's. Raises FirmwareError when that fails."""
    try:
        return own.load(module)
    except BfsimError as error:
        place = line_of(error)
        if place.strip(" ()").rpartition(":")[0] in str(error):  # its message names the place already
            raise
        raise type(error)(f"{error}{place}") from error
    except BaseException as error:
        if not is_failure(error):
            raise
        if isinstance(error, ModuleNotFoundError) and f"{module}.".startswith(f"{error.name}."):
            raise FirmwareError(
                f"the module {shown(module)} must be in {own.roots[0].folder}, but there is none"
            ) from None
        raise _failed(module, error) from error


def _failed(module: str, error: BaseException) -> FirmwareError:
    """Say what went wrong while `module` was imported, and on which of its lines."""
    said, place = printable(failure_of(error)), line_of(error)
    if (
        isinstance(error, SyntaxError) and error.filename and error.lineno
    ):  # a file that is not text has no line
        said, place = f"{type(error).__name__}: {cut(error.msg)}", f" ({error.filename}:{error.lineno})"
        if error.text and error.offset:
            place += pointed(error.text.rstrip(), max(0, error.offset - 1))
    return FirmwareError(f"importing {cut(module)} failed with {said}{place}")


def path_of(module: ModuleType) -> Path:
    """Return the file of a module, or the folder of a module without a file."""
    return Path(getattr(module, "__file__", None) or next(iter(module.__path__)))
