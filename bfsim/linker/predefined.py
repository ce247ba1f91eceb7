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

ARCHITECTURE = re.compile(r"\bARCHITECTURE\s*\(\s*([\w-]+)\s*\)")
# ADSP-BF592-A is a chip of its own; other names are followed by package and temperature, as in ADSP-BF561-SKBCZ.
_BLACKFIN = re.compile(r"ADSP-(BF[5-7]\d\d\w*)((?:-\w+)*)", re.IGNORECASE)


def chip_named(name: str) -> str:
    """Return the chip that ARCHITECTURE names, without its package; '' if it is not a Blackfin."""
    blackfin = _BLACKFIN.fullmatch(name)
    return f"ADSP-{blackfin[1].upper()}" if blackfin else ""


def chip_in(text: str) -> str:
    """Return the chip that the text of an LDF is for; '' if it names none, or one that is not a Blackfin."""
    found = ARCHITECTURE.search(text)
    return chip_named(found[1]) if found else ""


def macros_for(chip: str) -> dict[str, str]:
    """Return the macros that are defined before an LDF is read; without a chip, those that all chips have."""
    macros = {
        "__VISUALDSPVERSION__": VERSION,
        "__VERSIONNUM__": VERSION,
        "__VERSION__": '"5.0"',
        "_LINKER": "1",
        # The chips of these years all have the anomalies (05-00-0189, 05-00-0310) that these two are about.
        "__WORKAROUNDS_ENABLED": "1",
        "__WORKAROUND_AVOID_LDF_BLOCK_BOUNDARIES": "1",
    }
    if not chip:
        return macros
    name = chip.removeprefix("ADSP-")
    families = ("__ADSPBLACKFIN__", "__ADSPLPBLACKFIN__", f"__ADSP{name}__", f"__ADSP{name[:4]}x__")
    macros |= dict.fromkeys((*families, f"__ADSP{name[:3]}xx__"), "1")
    macros["__SILICON_REVISION__"] = SILICON_REVISION.get(name, ANY_REVISION)
    return macros
