/* Places along the flight path: what the map of space shows of each, and how likely something is in the way there.
 *
 * The evidence of a place is what the last frames matched at it, what of it they saw through, what without texture
 * stands there, and the tracks: a thing in the volume at its range, the ground. Each piece
 * adds to the log-odds that the place is occupied (space_odds.h), whichever track, region or line brought it. So a wall
 * whose pieces change tracks from frame to frame is still one place in the way.
 *
 * The path is free up to the last place before which each is seen through by FREE_SHARE of its lines of sight and is
 * occupied with a probability below FREE, also as far around as the aircraft may be off its path there: what is warned of
 * has to be in the way, and what is free must not come to be. */
#ifndef VISTA_PATH_PLACES_H
#define VISTA_PATH_PLACES_H

#include <stdbool.h>
#include <stdint.h>

#include "perceive/frame_view.h"
#include "space/space_map.h"
#include "vista/obstacle.h"

/* Distance from a place to the next, as a share of its own: no more than twice the tolerance of the map. */
#define VISTA_PLACE_STEP_SHARE 0.05
/* Radius of a place, as a share of the volume's: what touches its rim is passed as often as not. */
#define VISTA_PLACE_RADIUS_SHARE 0.8
#define VISTA_PATH_PLACES_MAX 128

/* The pieces of evidence, each 0 to 1, as the odds weigh them. */
typedef enum vista_place_piece {
  VISTA_PIECE_THING = 0,
  VISTA_PIECE_GROUND,
  VISTA_PIECE_VOTES,      /* frames in which something is matched at the place, of five; more tell no more */
  VISTA_PIECE_FEET,       /* the same for something without texture that stands there, less those votes */
  VISTA_PIECE_NOT_BEYOND, /* share of the lines of sight that are not known to go on */
  VISTA_PIECE_COUNT
} vista_place_piece;

typedef struct vista_path_place {
  double along_m;     /* the path, from the camera */
  double point_m[3];  /* world */
  double reach_m;     /* What is told at a range that differs by less is at this place. */
  vista_place_evidence shown;
  bool thing;  /* a confirmed thing that is in the collision volume by itself */
  bool ground; /* that the path meets */
  double probability; /* that the place is occupied */
} vista_path_place;

typedef struct vista_path_places {
  int32_t count;
  vista_path_place items[VISTA_PATH_PLACES_MAX]; /* by distance */
} vista_path_places;

/* Looks at the places along the path of the frame, which the map has taken already. */
void vista_path_places_look(const vista_frame_view *frame, const vista_space_map *map, vista_path_places *places);

/* Adds what the obstacles of the frame say, and sets the probabilities. */
void vista_path_places_judge(const vista_obstacle *obstacles, int32_t count, vista_path_places *places);

/* What is known of a place, for the odds and for learning them. */
void vista_path_place_pieces(const vista_path_place *place, double pieces[VISTA_PIECE_COUNT]);

/* How likely a place is occupied. */
double vista_path_place_probability(const vista_path_place *place);

/* Whether a place that was judged is free. */
bool vista_path_place_is_free(const vista_path_place *place);

/* Whether it is free, and the newest frame that has it in view sees through it, too: what is blind now calls nothing
 * free. */
bool vista_path_place_is_free_now(const vista_path_place *place);

/* Whether something is rather there than not. What is neither free nor occupied is unknown. */
bool vista_path_place_is_occupied(const vista_path_place *place);

/* How far a range may be off that is told of a place at this distance. */
double vista_path_place_reach_m(const vista_camera *camera, double along_m);

/* The length, or as far as disparities say anything if that is nearer. */
double vista_path_places_farthest_m(const vista_frame_view *frame, double length_m);

/* Whether enough is known of a place to warn of it. */
bool vista_path_place_is_known(const vista_path_place *place);

/* The nearest place that is warned of; null: none. */
const vista_path_place *vista_path_places_contact(const vista_path_places *places);

/* How likely one of the places at this distance is occupied; NaN where there is none. */
double vista_path_places_probability(const vista_path_places *places, double distance_m);

/* Whether one of the places at this distance may be occupied. True where there is none. */
bool vista_path_places_bear_out(const vista_path_places *places, double distance_m);

/* How far the path is free: from 0 to its length, or to where disparities say nothing if that is nearer. */
double vista_path_places_free_m(const vista_frame_view *frame, const vista_space_map *map,
                                const vista_path_places *places);

#endif
