#ifndef CIRCLE_CONSENSUS_H
#define CIRCLE_CONSENSUS_H

#include "twin.h"

KERNEL int32_t find_consensus(const uint32_t selected[], int32_t count, const int32_t area[], int32_t fit[]);

#endif
