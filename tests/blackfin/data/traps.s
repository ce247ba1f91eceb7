// Functions that come to what no kernel has.
  .text
  .global _trap
  .type _trap, STT_FUNC
_trap:
  EXCPT 3;
  RTS;
  .size _trap, .-_trap

  .global _idle
  .type _idle, STT_FUNC
_idle:
  IDLE;
  RTS;
  .size _idle, .-_idle
  .global _nothing
  .type _nothing, STT_FUNC
_nothing:
  .short 0xFFFF;
  .short 0xFFFF;
  .size _nothing, .-_nothing
  .global _halt
  .type _halt, STT_FUNC
_halt:
  HLT;
  RTS;
  .size _halt, .-_halt
