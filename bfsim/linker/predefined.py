"""The macros that the linker of VisualDSP++ defines by itself, most of them by the ARCHITECTURE."""

from __future__ import annotations

import re

VERSION = "0x05000000"  # VisualDSP++ 5.0, whose LDFs bfsim reads

# Silicon revision that VisualDSP++ 5.0 links for: "default_silicon_revision_from_archdef" in the headers of the LDFs
# that its wizard wrote for the BF533, BF536, BF537 and BF561; the others are taken from their family [assumed].
SILICON_REVISION = {
    "BF531": "0x5",
    "BF532": "0x5",
    "BF533": "0x5",
    "BF534": "0x3",
    "BF536": "0x3",
    "BF537": "0x3",
    "BF561": "0x5",
}
ANY_REVISION = "0xffff"  # the default LDF of the BF533 takes it for all revisions

_ARCHITECTURE = re.compile(r"^[ \t]*ARCHITECTURE\s*\(\s*([\w-]+)", re.MULTILINE)
_BLACKFIN = re.compile(r"ADSP-(BF[5-7]\d\d\w*)", re.IGNORECASE)


def is_blackfin(chip: str) -> bool:
    """Say whether `chip` is the name of one of the family."""
    return _BLACKFIN.fullmatch(chip) is not None


def macros_for(written: str) -> dict[str, str]:
    """Return the macros that are defined before the LDF with the text `written` is read."""
    macros = {
        "__VISUALDSPVERSION__": VERSION,
        "__VERSIONNUM__": VERSION,
        "__VERSION__": '"5.0"',
        "_LINKER": "1",
        # The chips of these years all have the anomalies (05-00-0189, 05-00-0310) that these two are about.
        "__WORKAROUNDS_ENABLED": "1",
        "__WORKAROUND_AVOID_LDF_BLOCK_BOUNDARIES": "1",
    }
    architecture = _ARCHITECTURE.search(written)
    chip = _BLACKFIN.fullmatch(architecture[1]) if architecture else None
    if chip is None:
        return macros
    name = chip[1].upper()
    families = ("__ADSPBLACKFIN__", "__ADSPLPBLACKFIN__", f"__ADSP{name}__", f"__ADSP{name[:4]}x__")
    macros |= dict.fromkeys((*families, f"__ADSP{name[:3]}xx__"), "1")
    macros["__SILICON_REVISION__"] = SILICON_REVISION.get(name, ANY_REVISION)
    return macros
