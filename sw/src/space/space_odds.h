/* Written by `vista train` from 73 flights of 22 families; do not edit.
 * Digest of what was learned from: 43c7dc2bf7d9bf096f9806faf88ac21bdab2b06a9a9fdb9b6317a6c9c9162a28
 *
 * Log-odds that a place on the flight path is occupied: what each piece of evidence adds (path_places.h). */
#ifndef VISTA_SRC_SPACE_ODDS_H
#define VISTA_SRC_SPACE_ODDS_H

#define VISTA_ODDS_WARN 0.8 /* the probability from which on a place is warned of */
#define VISTA_ODDS_PRIOR (-3.95)
#define VISTA_ODDS_THING 5.44
#define VISTA_ODDS_GROUND 6.58
#define VISTA_ODDS_VOTES 9.22
#define VISTA_ODDS_FEET 7.36
#define VISTA_ODDS_NOT_BEYOND 2.01

#endif
