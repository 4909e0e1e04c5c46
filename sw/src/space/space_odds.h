/* Log-odds that a place on the flight path is occupied: what each piece of evidence adds (path_places.h). */
#ifndef VISTA_SRC_SPACE_ODDS_H
#define VISTA_SRC_SPACE_ODDS_H

#define VISTA_ODDS_PRIOR (-3.26)
#define VISTA_ODDS_THING 2.96
#define VISTA_ODDS_BESIDE 3.24
#define VISTA_ODDS_GROUND 5.37
#define VISTA_ODDS_VOTES 5.17
#define VISTA_ODDS_FEET 3.66
#define VISTA_ODDS_NOT_BEYOND 2.34

#endif
