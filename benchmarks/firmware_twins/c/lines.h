#ifndef LINES_H
#define LINES_H

/* half-words of a line */
#define LINE_X0 0
#define LINE_Y0 1
#define LINE_X1 2
#define LINE_Y1 3
#define LINE_ANGLE 4
#define LINE_EDGES 5
#define LINE_PROBABILITY 6
#define LINE_BEHIND 7
#define LINE_AHEAD 8
#define LINE_WORDS 9

#define SUBPIXELS 16

#endif
