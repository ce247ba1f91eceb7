"""Control flow: jumps, calls, branches, hardware loops, stack frames."""

from bfsim.blackfin.instructions.form import Form

FORMS = (
    Form("return_", "0000 0000 0001 0000", "RTS"),
    Form("jump_to", "0000 0000 0101 0ppp", "JUMP ({p:P})"),
    Form("call_to", "0000 0000 0110 0ppp", "CALL ({p:P})"),
    Form("call_relative", "0000 0000 0111 0ppp", "CALL (PC + {p:P})"),
    Form("jump_relative", "0000 0000 1000 0ppp", "JUMP (PC + {p:P})"),
    Form("branch", "0001 00tt tttt tttt", "IF !CC JUMP {t:target10}", {"when": 0}),
    Form("branch_predicted", "0001 01tt tttt tttt", "IF !CC JUMP {t:target10} (BP)", {"when": 0}),
    Form("branch", "0001 10tt tttt tttt", "IF CC JUMP {t:target10}", {"when": 1}),
    Form("branch_predicted", "0001 11tt tttt tttt", "IF CC JUMP {t:target10} (BP)", {"when": 1}),
    Form("jump", "0010 tttt tttt tttt", "JUMP.S {t:target12}"),
    Form("jump", "1110 0010 tttt tttt tttt tttt tttt tttt", "JUMP.L {t:target24}"),
    Form("call", "1110 0011 tttt tttt tttt tttt tttt tttt", "CALL {t:target24}"),
    Form(
        "loop_setup",
        "1110 0000 100c ssss 0--- 00ee eeee eeee",
        "LSETUP({s:target4}, {e:end10}) LC{c:decimal}",
    ),
    Form(
        "loop_setup",
        "1110 0000 101c ssss 0ppp 00ee eeee eeee",
        "LSETUP({s:target4}, {e:end10}) LC{c:decimal} = {p:P}",
    ),
    Form(
        "loop_setup",
        "1110 0000 111c ssss 0ppp 00ee eeee eeee",
        "LSETUP({s:target4}, {e:end10}) LC{c:decimal} = {p:P} >> 0x1",
        {"halved": 1},
    ),
    Form("link", "1110 1000 0000 0000 nnnn nnnn nnnn nnnn", "LINK {n:count4}"),
    Form("unlink", "1110 1000 0000 0001 ---- ---- ---- ----", "UNLINK"),
)
