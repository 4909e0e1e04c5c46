/* The detector from end to end: a raw pair, the time and the pose in, obstacles out. It rectifies, matches with the
 * engine in C or takes words from another one, keeps the cameras aligned (vista/correction.h), runs the pipeline
 * (vista/pipeline.h), and says what is wrong with a frame.
 *
 *   vista_detector_options options = {0};
 *   vista_detector_bytes(&parameters, &rig, &options, &bytes);
 *   vista_detector_create(malloc(bytes), bytes, &parameters, &rig, &options, &detector);
 *   for each pair:
 *     vista_detector_pair pair = {.left = ..., .right = ..., .t_ns = ...};
 *     vista_detector_place place = {.pose = ...};
 *     vista_novelty novelty;
 *     vista_detector_result result;
 *     vista_detector_process(detector, &pair, &place, &novelty, &result);
 *     unless novelty == VISTA_PAIR_REPEATED: vista_detector_write_line(&result, ...);
 *   vista_detector_destroy(detector);
 *
 * vista_detector_process does three steps in turn that a program may also do one by one: vista_detector_take looks at a
 * pair and rectifies it, vista_detector_match finds its disparities, vista_detector_judge finds the obstacles. So a pose
 * may still arrive while a pair is matched, and words may come from an engine elsewhere, which matches the rectified pair
 * of vista_detector_matched_pair.
 *
 * All memory is the caller's. After creation nothing is allocated. A step keeps no pointer that it is given. The memory
 * may have any alignment; on large pages a frame takes some 4 % less time. One thread at a time uses a detector. */
#ifndef VISTA_DETECTOR_H
#define VISTA_DETECTOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "vista/alignment.h"
#include "vista/api.h"
#include "vista/directions.h"
#include "vista/line.h"
#include "vista/obstacle.h"
#include "vista/parameters.h"
#include "vista/pipeline.h"
#include "vista/rig.h"
#include "vista/status.h"
#include "vista/types.h"

VISTA_BEGIN

typedef struct vista_detector vista_detector;

/* What a program knows of its source. */
typedef struct vista_detector_options {
  bool every_pair; /* judges pairs that repeat the one before, too: a recording that is played patiently */
  bool stills; /* each pair shows another scene: it is judged by itself, and one hit confirms an obstacle */
  bool other_words; /* words come from a matcher that is not the one of the contract, and are not compared with its */
  bool motion_watched; /* the program finds out by itself whether the camera moves where no pose is given */
} vista_detector_options;

/* A pair as it comes from the cameras. */
typedef struct vista_detector_pair {
  vista_image left,
      right; /* of the size of the camera; where words come from elsewhere the right one, or both, may be all zero */
  int64_t t_ns;
  bool restarts;  /* the pair does not continue what came before: another flight */
  bool rectified; /* the images are rectified already, as in a recording of words */
} vista_detector_pair;

/* What is decided of a pair before it is matched. */
typedef enum vista_novelty {
  VISTA_PAIR_NEW = 0,
  VISTA_PAIR_REPEATED, /* time or images are those of the pair before: it says nothing, and there is nothing to do */
  VISTA_PAIR_RESTARTED /* it begins anew, or its time went back: everything that came before was forgotten */
} vista_novelty;

/* The rectified pair in work, and its words. Valid until the next pair is taken. */
typedef struct vista_detector_matched {
  vista_image left, right;                               /* without data where none was given */
  vista_disparity_image words[1 + VISTA_COARSER_LEVELS]; /* without data before the match */
  int32_t levels;
} vista_detector_matched;

/* The place and the motion of the camera at the time of a pair. Members that are left out stand for "not known"; see vista_frame. */
typedef struct vista_detector_place {
  const vista_pose *pose; /* of the rectified left camera; vista_rig_rectified_pose makes it from that of the raw one */
  const double *up_world, *velocity_m_s; /* 3 numbers each */
  bool stationary;
  bool
      anew; /* the poses began anew: tracks are dropped, and the reason pose_jump is given. The cameras are as before */
} vista_detector_place;

/* One thing that is wrong with a frame. */
typedef struct vista_finding {
  vista_health_state state; /* degraded or blind */
  const char *reason; /* its name in obstacles.schema.json */
  const char *text; /* a sentence for people */
} vista_finding;

/* What one pair gave. Its pointers are valid until the next pair is taken. */
typedef struct vista_detector_result {
  vista_result result;
  vista_directions directions;
  vista_alignment_result alignment; /* of zeros where no two images are given */
  int32_t finding_count;
  vista_finding findings[VISTA_LINE_REASONS]; /* calibration, images, alignment, motion, then those of vista_result */
  int32_t next_finding; /* where vista_detector_add puts the next one */
  vista_line_health health; /* the same as states and names */
  double rectify_ms, match_ms, alignment_ms, watch_ms;
  bool shown; /* the images show something: not one grey level, and not both the same */
} vista_detector_result;

/* The number of bytes that a detector needs. Errors as vista_detector_create. */
VISTA_API vista_status vista_detector_bytes(const vista_parameters *parameters, const vista_rig *rig,
                                            const vista_detector_options *options, size_t *bytes);

/* Makes a detector in the memory given.
 *
 * - VISTA_ERROR_RANGE: a parameter or a number of the camera; also rectify_rows, where it is not that of the rig.
 * - VISTA_ERROR_SIZE: images of this size are not handled.
 * - VISTA_ERROR_NUMBER: a number of a camera is not finite.
 * - VISTA_ERROR_MEMORY: there are too few bytes.
 * - VISTA_ERROR_THREAD: the system gives no second thread (host.threads). */
VISTA_API vista_status vista_detector_create(void *memory, size_t bytes, const vista_parameters *parameters,
                                             const vista_rig *rig, const vista_detector_options *options,
                                             vista_detector **detector);

/* Ends the second thread, as vista_pipeline_destroy does. Null is allowed. */
VISTA_API void vista_detector_destroy(vista_detector *detector);

/* What comes next does not continue what came before. vista_detector_take does it by itself at a restart. */
VISTA_API void vista_detector_reset(vista_detector *detector);

/* Forgets the tracks alone, as after a frame that was refused. The cameras are as they were. */
VISTA_API void vista_detector_forget(vista_detector *detector);

/* Decides whether a pair is new, and rectifies it unless it is repeated. Without images a pair is repeated if its time is.
 * VISTA_ERROR_ARGUMENT: there is a right image and no left one, or one without data that has a size. VISTA_ERROR_SIZE: an
 * image of another size. */
VISTA_API vista_status vista_detector_take(vista_detector *detector, const vista_detector_pair *pair,
                                           vista_novelty *novelty);

/* Matches the pair that was taken. words: of each level from elsewhere, stereo.levels of them; null: the engine in C
 * matches. VISTA_ERROR_ARGUMENT: no pair was taken, it has no right image to match, or a level has no data.
 * VISTA_ERROR_SIZE: a level of another size. */
VISTA_API vista_status vista_detector_match(vista_detector *detector, const vista_disparity_image *words);

/* The pair that was taken, with its words once it was matched. */
VISTA_API vista_detector_matched vista_detector_matched_pair(const vista_detector *detector);

/* How right images are rectified now; an engine that does it by itself has to follow when alignment.changed. */
VISTA_API vista_right_table vista_detector_right_table(const vista_detector *detector);

/* Finds the obstacles of the pair that was matched. VISTA_ERROR_ARGUMENT: none was. Other errors as
 * vista_pipeline_process; tracks are then as before. */
VISTA_API vista_status vista_detector_judge(vista_detector *detector, const vista_detector_place *place,
                                            vista_detector_result *result);

/* Takes, matches with the engine in C, and judges. At a pair that is repeated *result is not written. */
VISTA_API vista_status vista_detector_process(vista_detector *detector, const vista_detector_pair *pair,
                                              const vista_detector_place *place, vista_novelty *novelty,
                                              vista_detector_result *result);

/* Adds what a program has found besides, before what the pipeline itself says; a reason that the pipeline gives as well
 * is named once. More than VISTA_LINE_REASONS are dropped. */
VISTA_API void vista_detector_add(vista_detector_result *result, const vista_finding *finding);

/* Writes the line of a frame, as vista_line_write does. */
VISTA_API vista_status vista_detector_write_line(const vista_detector_result *result, int64_t frame, int64_t t_ns,
                                                 bool all_tracks, char *text, size_t capacity, size_t *length);

VISTA_END

#endif
