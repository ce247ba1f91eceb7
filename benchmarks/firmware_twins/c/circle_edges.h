#ifndef CIRCLE_EDGES_H
#define CIRCLE_EDGES_H

#include "twin.h"

#define FINE 64

/* words of the area */
#define LEFT 0
#define RIGHT 1
#define MASS_X 4
#define MASS_Y 5
#define REACH 6
#define BORDERING 7

KERNEL int32_t edge_x(uint32_t edge);
KERNEL int32_t edge_y(uint32_t edge);
KERNEL int32_t looks_away(uint32_t edge);

#endif
