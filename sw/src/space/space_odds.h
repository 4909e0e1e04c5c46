/* Log-odds that a place on the flight path is occupied: what each piece of evidence adds (path_places.h). */
#ifndef VISTA_SRC_SPACE_ODDS_H
#define VISTA_SRC_SPACE_ODDS_H

#define VISTA_ODDS_PRIOR (-3.9)
#define VISTA_ODDS_THING 4.6
#define VISTA_ODDS_BESIDE 2.3
#define VISTA_ODDS_GROUND 6.1
#define VISTA_ODDS_VOTES 5.8
#define VISTA_ODDS_FEET 3.5
#define VISTA_ODDS_NOT_BEYOND 2.5

#endif
