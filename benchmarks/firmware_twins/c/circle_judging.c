/* Twin of tinyphoon/stages/circle_judging.py: `judge_consensus`. */
#include "circle_consensus.h"
#include "circle_edges.h"
#include "circle_fit.h"

/* words of a circle */
#define CIRCLE_TESTS 7
#define CIRCLE_WORDS 9

#define CENTRE_PASSED 1
#define RADIUS_PASSED 2

KERNEL int32_t judge_consensus(const uint32_t selected[], int32_t count, const int32_t area[],
                               int32_t consensus_share, int32_t passed, int32_t fit[], int16_t circles[],
                               int32_t number)
{
    if (passed == 0)
        fit[RADIUS] = 0;
    int32_t share = floor_div(find_consensus(selected, count, area, fit) * count, area[BORDERING]);
    if (passed == 0 && share <= consensus_share)
        return 0;
    circles[number * CIRCLE_WORDS + CIRCLE_TESTS] = CENTRE_PASSED | RADIUS_PASSED;
    return 1;
}
