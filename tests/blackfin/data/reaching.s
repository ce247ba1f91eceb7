/* Every relocation that bfsim applies. */
.text
.global _start
.type _start, STT_FUNC
_start:
  CALL _behind;
  JUMP.L _behind;
  JUMP.S _near;
  IF CC JUMP _near;
  P0.L = _table;
  P0.H = _table;
  R0 = _small (X);
  RTS;
.size _start, . - _start
.global _near
_near:
  NOP;
  RTS;
.global _behind
.type _behind, STT_FUNC
_behind:
  RTS;
.size _behind, . - _behind
.data
.global _table
_table:
  .long _behind
  .long _table + 8
  .short _small
  .byte _small
  .byte 0
.global _small
.set _small, 0x12
.bss
  .skip 16
