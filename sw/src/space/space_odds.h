/* Written by `vista train` from 73 flights of 22 families; do not edit.
 * Digest of what was learned from: 0cfad3e5477d3bc36c530354c2dbaf573d2707b2c1f1f3ee6a9bb72dacf405f0
 *
 * Log-odds that a place on the flight path is occupied: what each piece of evidence adds (path_places.h). */
#ifndef VISTA_SRC_SPACE_ODDS_H
#define VISTA_SRC_SPACE_ODDS_H

#define VISTA_ODDS_PRIOR (-3.77)
#define VISTA_ODDS_THING 3.46
#define VISTA_ODDS_BESIDE 3.21
#define VISTA_ODDS_GROUND 6.70
#define VISTA_ODDS_VOTES 5.28
#define VISTA_ODDS_FEET 4.53
#define VISTA_ODDS_NOT_BEYOND 2.87

#endif
