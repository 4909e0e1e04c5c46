/* Written by `vista train` from 73 flights of 22 families; do not edit.
 * Digest of what was learned from: 623416c479de67bb53afeeb7078beb37711d9fd65f6efde176a75f58031465c4
 *
 * Log-odds that a place on the flight path is occupied: what each piece of evidence adds (path_places.h). */
#ifndef VISTA_SRC_SPACE_ODDS_H
#define VISTA_SRC_SPACE_ODDS_H

#define VISTA_ODDS_WARN 0.8 /* the probability from which on a place is warned of */
#define VISTA_ODDS_PRIOR (-3.95)
#define VISTA_ODDS_THING 3.85
#define VISTA_ODDS_BESIDE 2.22
#define VISTA_ODDS_GROUND 6.58
#define VISTA_ODDS_VOTES 9.08
#define VISTA_ODDS_FEET 7.38
#define VISTA_ODDS_NOT_BEYOND 2.02

#endif
