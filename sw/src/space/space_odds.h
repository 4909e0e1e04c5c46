/* Written by `vista train` from 73 flights of 22 families; do not edit.
 * Digest of what was learned from: 92d874d567052a44ac064d6800958c9fdc2f01944061c5fa1cbc519dcb46ff11
 *
 * Log-odds that a place on the flight path is occupied: what each piece of evidence adds (path_places.h). */
#ifndef VISTA_SRC_SPACE_ODDS_H
#define VISTA_SRC_SPACE_ODDS_H

#define VISTA_ODDS_WARN 0.8 /* the probability from which on a place is warned of */
#define VISTA_ODDS_PRIOR (-3.79)
#define VISTA_ODDS_THING 3.50
#define VISTA_ODDS_BESIDE 3.23
#define VISTA_ODDS_GROUND 6.73
#define VISTA_ODDS_VOTES 6.7
#define VISTA_ODDS_FEET 5.6
#define VISTA_ODDS_NOT_BEYOND 2.63

#endif
