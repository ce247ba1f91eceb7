"""Pseudo-instructions that only simulators have: programs that test themselves use them."""

from bfsim.blackfin.instructions.form import Form

FORMS = (
    Form("debug", "1111 1000 00gg gggg", "DBG {g:any}"),
    Form("debug", "1111 1000 11-- -000", "DBG A0"),
    Form("debug", "1111 1000 11-- -001", "DBG A1"),
    Form("abort", "1111 1000 11-- -011", "ABORT"),
    Form("halt", "1111 1000 11-- -100", "HLT"),
    Form("output_register", "1111 1000 1000 0ddd", "OUTC {d:R}"),
    Form("output", "1111 1001 cccc cccc", "OUTC {c:count}"),
    Form("assert_low", "1111 0--- 00gg gggg nnnn nnnn nnnn nnnn", "DBGA ({g:dag}.L, {n:count})"),
    Form("assert_high", "1111 0--- 01gg gggg nnnn nnnn nnnn nnnn", "DBGA ({g:dag}.H, {n:count})"),
    Form("assert_low", "1111 0--- 10gg gggg nnnn nnnn nnnn nnnn", "DBGAL ({g:any}, {n:count})"),
    Form("assert_high", "1111 0--- 11gg gggg nnnn nnnn nnnn nnnn", "DBGAH ({g:any}, {n:count})"),
)
