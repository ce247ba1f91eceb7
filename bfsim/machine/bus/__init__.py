"""The bus to the SDRAM and the port of L2: who may move a word when, in compiled code."""
