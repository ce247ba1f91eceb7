/* What rows of both edge stores share. */
#ifndef EDGE_ROWS_H
#define EDGE_ROWS_H

#include "twin.h"

#define REACH 2
#define WINDOW_ROWS (2 * REACH + 1)

#endif
