"""Arithmetic and logic of 32 bits in 16-bit instructions: on data registers with flags, on pointers without."""

from bfsim.blackfin.instructions.form import Form

FORMS = (
    # on two data registers
    Form("shift_by_register", "0100 0000 00ss sddd", "{d:R} >>>= {s:R}", {"how": "arithmetic"}),
    Form("shift_by_register", "0100 0000 01ss sddd", "{d:R} >>= {s:R}", {"how": "right"}),
    Form("shift_by_register", "0100 0000 10ss sddd", "{d:R} <<= {s:R}", {"how": "left"}),
    Form("multiply_32", "0100 0000 11ss sddd", "{d:R} *= {s:R}"),
    Form("add_and_shift", "0100 0001 00ss sddd", "{d:R} = ({d:R} + {s:R}) << 0x1", {"shift": 1}),
    Form("add_and_shift", "0100 0001 01ss sddd", "{d:R} = ({d:R} + {s:R}) << 0x2", {"shift": 2}),
    Form("divide_step", "0100 0010 00ss sddd", "DIVQ ({d:R}, {s:R})"),
    Form("divide_sign", "0100 0010 01ss sddd", "DIVS ({d:R}, {s:R})"),
    Form("extend", "0100 0010 10ss sddd", "{d:R} = {s:R}.L (X)", {"bits": 16, "signed": 1}),
    Form("extend", "0100 0010 11ss sddd", "{d:R} = {s:R}.L (Z)", {"bits": 16, "signed": 0}),
    Form("extend", "0100 0011 00ss sddd", "{d:R} = {s:R}.B (X)", {"bits": 8, "signed": 1}),
    Form("extend", "0100 0011 01ss sddd", "{d:R} = {s:R}.B (Z)", {"bits": 8, "signed": 0}),
    Form("negate", "0100 0011 10ss sddd", "{d:R} = -{s:R}"),
    Form("invert", "0100 0011 11ss sddd", "{d:R} =~ {s:R}"),
    # on a data register and a constant
    Form("change_bit", "0100 1010 bbbb bddd", "BITSET ({d:R}, {b:count})", {"how": "set"}),
    Form("change_bit", "0100 1011 bbbb bddd", "BITTGL ({d:R}, {b:count})", {"how": "toggle"}),
    Form("change_bit", "0100 1100 bbbb bddd", "BITCLR ({d:R}, {b:count})", {"how": "clear"}),
    Form("shift", "0100 1101 bbbb bddd", "{d:R} >>>= {b:count}", {"how": "arithmetic"}),
    Form("shift", "0100 1110 bbbb bddd", "{d:R} >>= {b:count}", {"how": "right"}),
    Form("shift", "0100 1111 bbbb bddd", "{d:R} <<= {b:count}", {"how": "left"}),
    # on three data registers
    Form("add", "0101 000d ddtt tsss", "{d:R} = {s:R} + {t:R}"),
    Form("subtract", "0101 001d ddtt tsss", "{d:R} = {s:R} - {t:R}"),
    Form("logic", "0101 010d ddtt tsss", "{d:R} = {s:R} & {t:R}", {"operator": "&"}),
    Form("logic", "0101 011d ddtt tsss", "{d:R} = {s:R} | {t:R}", {"operator": "|"}),
    Form("logic", "0101 100d ddtt tsss", "{d:R} = {s:R} ^ {t:R}", {"operator": "^"}),
    # on pointers
    Form(
        "shift_pointer",
        "0101 101d ddtt tsss",
        "{d:P} = {s:P} << 0x1",
        {"by": 1},
        only=lambda d, s, t: s == t,
        unprinted="{t:P}",
    ),
    Form("add_pointers", "0101 101d ddtt tsss", "{d:P} = {s:P} + {t:P}", {"shift": 0}),
    Form("add_pointers", "0101 110d ddtt tsss", "{d:P} = {s:P} + ({t:P} << 0x1)", {"shift": 1}),
    Form("add_pointers", "0101 111d ddtt tsss", "{d:P} = {s:P} + ({t:P} << 0x2)", {"shift": 2}),
    Form("subtract_pointer", "0100 0100 00ss sddd", "{d:P} -= {s:P}"),
    Form("shift_pointer", "0100 0100 01ss sddd", "{d:P} = {s:P} << 0x2", {"by": 2}),
    Form("shift_pointer", "0100 0100 11ss sddd", "{d:P} = {s:P} >> 0x2", {"by": -2}),
    Form("shift_pointer", "0100 0101 00ss sddd", "{d:P} = {s:P} >> 0x1", {"by": -1}),
    Form("add_reversed", "0100 0101 01ss sddd", "{d:P} += {s:P} (BREV)"),
    Form("add_and_shift_pointers", "0100 0101 10ss sddd", "{d:P} = ({d:P} + {s:P}) << 0x1", {"shift": 1}),
    Form("add_and_shift_pointers", "0100 0101 11ss sddd", "{d:P} = ({d:P} + {s:P}) << 0x2", {"shift": 2}),
)
