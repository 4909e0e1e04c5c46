/* Written by `vista train` from 73 flights of 22 families; do not edit.
 * Digest of what was learned from: 8721901f96f44f43989fd993d6910c558b8f4ad53f6e24b929bda31478761a1d
 *
 * Log-odds that a place on the flight path is occupied: what each piece of evidence adds (path_places.h). */
#ifndef VISTA_SRC_SPACE_ODDS_H
#define VISTA_SRC_SPACE_ODDS_H

#define VISTA_ODDS_PRIOR (-3.47)
#define VISTA_ODDS_THING 3.44
#define VISTA_ODDS_BESIDE 3.15
#define VISTA_ODDS_GROUND 6.19
#define VISTA_ODDS_VOTES 4.85
#define VISTA_ODDS_FEET 4.25
#define VISTA_ODDS_NOT_BEYOND 2.95

#endif
