/* Written by `vista train` from 73 flights of 22 families; do not edit.
 * Digest of what was learned from: fc89f54ddba693f2dc1b0046080a8d00684f2ddb95f7734e62208316fc14dd57
 *
 * Log-odds that a place on the flight path is occupied: what each piece of evidence adds (path_places.h). */
#ifndef VISTA_SRC_SPACE_ODDS_H
#define VISTA_SRC_SPACE_ODDS_H

#define VISTA_ODDS_WARN 0.8 /* the probability from which on a place is warned of */
#define VISTA_ODDS_PRIOR (-3.99)
#define VISTA_ODDS_THING 5.63
#define VISTA_ODDS_GROUND 6.61
#define VISTA_ODDS_VOTES 9.28
#define VISTA_ODDS_FEET 7.34
#define VISTA_ODDS_NOT_BEYOND 2.07

#endif
