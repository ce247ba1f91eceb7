"""DMA: the channels with their registers, and the memory DMA streams that rings and firmware use."""
