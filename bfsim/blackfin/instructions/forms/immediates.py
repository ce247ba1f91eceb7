"""Constants into registers."""

from bfsim.blackfin.instructions.form import Form

FORMS = (
    Form("set_register", "0110 00ii iiii iddd", "{d:R} = {i:imm7} (X)"),
    Form("add_immediate", "0110 01ii iiii iddd", "{d:R} += {i:imm7}"),
    Form("set_register", "0110 10ii iiii iddd", "{d:P} = {i:imm7} (X)"),
    Form("add_immediate_pointer", "0110 11ii iiii iddd", "{d:P} += {i:imm7}"),
    Form("set_low", "1110 0001 000d dddd iiii iiii iiii iiii", "{d:dag}.L = {i:count}"),
    Form("set_high", "1110 0001 010d dddd iiii iiii iiii iiii", "{d:dag}.H = {i:count}"),
    Form("set_register", "1110 0001 001d dddd iiii iiii iiii iiii", "{d:dag} = {i:imm16} (X)"),
    Form("set_register", "1110 0001 100d dddd iiii iiii iiii iiii", "{d:dag} = {i:count} (Z)"),
)
