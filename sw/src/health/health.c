#include "health/health.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/agreement.h"
#include "common/frame.h"
#include "common/median.h"
#include "common/numbers.h"
#include "perceive/frame_view.h"

#define ROW_STEP 2 /* neighbouring rows say the same */

typedef struct entry {
  const char *name, *text;
  uint32_t blinding; /* 1: what has this reason is blind */
} entry;

static const entry reasons[VISTA_HEALTH_REASON_COUNT] = {
    {"few_disparities", "few pixels have a disparity", 0},
    {"no_disparities", "hardly any pixel has a disparity", 1},
    {"no_contrast", "the image is hardly more than one grey level", 1},
    {"motion_unknown", "the pose is missing: positions rest on the last known motion", 0},
    {"pose_jump", "the pose jumped farther than the vehicle can have moved", 0},
    {"noise", "the noise of the images leaves few disparities that chance does not explain", 0},
    {"ground_unseen", "hardly anything below the horizon where the flight leads to has a disparity", 0},
    {"alignment_lost", "the right camera has turned by more than is corrected, or by an angle that cannot be found", 1},
    {"rows_misaligned", "matching features lie apart in rows", 0},
    {"images_frozen", "an image is the one of the pair before although the vehicle moves: does a camera stand still?",
     1},
    {"view_stuck", "part of the image where the flight leads stays as it is although the vehicle moves", 0},
    {"moments_differ", "matching features agree on no rows: do left and right image, in this order, show one moment?",
     1},
    {"words_differ", "the words of the engine are not those of the images", 1},
    {"motion_doubtful", "the image moves otherwise than the poses say", 0},
    {"disparities_off",
     "disparities do not change as the motion says: has a camera turned, or is the baseline or the speed wrong?", 0},
    {"time_jump", "the times went back or far ahead: what was seen before is of no use", 0},
    {"crowded", "more things are seen than are followed: the farthest are left out", 0},
    {"image_missing",
     "no image came with the words: thin things and what is too near to match are not looked for, and nothing checks "
     "the cameras, the words or the motion",
     0},
};

static const char *const state_names[VISTA_HEALTH_STATE_COUNT] = {"healthy", "degraded", "blind"};

const char *vista_health_state_name(vista_health_state state) {
  return (unsigned)state < VISTA_HEALTH_STATE_COUNT ? state_names[state] : "unknown";
}

const char *vista_health_reason_name(vista_health_reason reason) {
  return (unsigned)reason < VISTA_HEALTH_REASON_COUNT ? reasons[reason].name : "unknown";
}

const char *vista_health_reason_text(vista_health_reason reason) {
  return (unsigned)reason < VISTA_HEALTH_REASON_COUNT ? reasons[reason].text : "unknown reason";
}

vista_health_state vista_health_reason_state(vista_health_reason reason) {
  return reasons[reason].blinding ? VISTA_HEALTH_BLIND : VISTA_HEALTH_DEGRADED;
}

void vista_health_add(vista_health *health, vista_health_reason reason) {
  const vista_health_state state = vista_health_reason_state(reason);
  health->reasons |= UINT32_C(1) << reason;
  if (state > health->state) health->state = state;
}

/* Standard deviation of the cells' grey levels, by the pixels that they own, without the noise that is left in them. */
static double contrast_of(const vista_foveation *foveation, const vista_cells *cells, const vista_image_noise *noise) {
  double pixels = 0.0, sum = 0.0, squares = 0.0;
  for (int32_t i = 0; i < foveation->node_count; ++i) {
    const double weight = foveation->pixel_count[i], grey = (double)cells->intensity[i];
    pixels += weight;
    sum += weight * grey;
    squares += weight * grey * grey;
  }
  const double mean = sum / pixels;
  const double of_noise = vista_square(noise->sigma) * foveation->node_count / pixels; /* of n pixels: sigma^2 / n */
  return sqrt(fmax(squares / pixels - mean * mean - of_noise, 0.0));
}

typedef struct counted_words {
  int64_t image;                 /* valid ones */
  int64_t matched, matched_area; /* valid ones in the matched area, and its pixels */
  /* The same where both neighbours in question are in the area, too: */
  int64_t agreeing, asked; /* valid ones that another one agrees with, and the pixels */
} counted_words;

static double share(int64_t part, int64_t whole) { return whole > 0 ? (double)part / (double)whole : 0.0; }

static int32_t count_agreeing(const int16_t *words, int32_t count, int32_t distance) {
  int32_t sum = 0;
  for (int32_t u = 0; u < count; ++u) sum += vista_word_agrees(words, u, distance);
  return sum;
}

/* noisy: agreement is asked for, else none is. */
static counted_words count(const vista_matched_area *matched, bool noisy, const vista_disparity_image *disparity) {
  const int32_t margin = (int32_t)matched->margin_px, first = (int32_t)matched->margin_left_px;
  const int32_t end = disparity->width_px - margin, distance = vista_agreement_distance(matched);
  counted_words sum = {0};
  for (int32_t v = 0; v < disparity->height_px; ++v) {
    const int16_t *const row = disparity->data + v * disparity->stride;
    sum.image += vista_count_valid(row, disparity->width_px);
    if (v < margin || v >= disparity->height_px - margin || first >= end) continue;
    sum.matched += vista_count_valid(row + first, end - first);
    sum.matched_area += end - first;
    const int32_t asked = end - first - 2 * distance;
    if (!noisy || (v - margin) % ROW_STEP != 0 || asked <= 0) continue;
    sum.agreeing += count_agreeing(row + first + distance, asked, distance);
    sum.asked += asked;
  }
  return sum;
}

#define LOOK_M 30.0    /* The columns that are asked are as wide as the collision volume is so far along the path. */
#define SIDEWAYS_M 3.0 /* Nearer along the optical axis than this the path leaves the view to the side. */
#define STEP_PX 4
#define SAMPLES_MIN 50

/* Share of what is below the horizon, where the aircraft flies to, that has a disparity. Whatever is seen there is the
 * ground or something before it. A plain wall, dark glass or sheet metal that cannot be matched hides that ground and
 * leaves nothing in its place, although the rest of the image may be full of disparities. The share is 1 where hardly
 * anything below the horizon is in view, or where nobody knows where the horizon is. agreeing: only disparities that
 * another one agrees with count. */
static double ground_view(const vista_frame_view *frame, bool agreeing) {
  const vista_camera *const camera = frame->camera;
  const vista_matched_area *const matched = &frame->matched;
  const vista_disparity_image *const disparity = &frame->words;
  const double *const up = frame->up_camera, radius_m = frame->params->obstacle_map.collision_radius_m;
  if (!frame->up_known) return 1.0;
  double point_m[3], at_m[3];
  vista_flight_path_point(&frame->path, fmin(LOOK_M, frame->path.length_m), point_m, NULL);
  vista_frame_to_camera(&frame->motion.pose, point_m, at_m);
  if (!(at_m[2] > SIDEWAYS_M)) return 1.0;
  const double scale = camera->focal_px / at_m[2], middle = camera->center_u_px + scale * at_m[0];
  const int32_t distance = agreeing ? vista_agreement_distance(matched) : 0, margin = (int32_t)matched->margin_px;
  const int32_t left = (int32_t)matched->margin_left_px + distance, right = disparity->width_px - margin - distance;
  const int32_t first = (int32_t)fmin(fmax(middle - scale * radius_m, left), right);
  const int32_t end = (int32_t)fmin(fmax(middle + scale * radius_m, left), right);
  int32_t seen = 0, asked = 0;
  for (int32_t v = margin; v < disparity->height_px - margin; v += STEP_PX) {
    const int16_t *const row = disparity->data + v * disparity->stride;
    const double y = (v - camera->center_v_px) / camera->focal_px;
    for (int32_t u = first; u < end; u += STEP_PX) {
      const double x = (u - camera->center_u_px) / camera->focal_px;
      if (x * up[0] + y * up[1] + up[2] >= 0.0) continue;
      ++asked;
      seen += agreeing ? vista_word_agrees(row, u, distance) : row[u] >= 0;
    }
  }
  return asked >= SAMPLES_MIN ? (double)seen / asked : 1.0;
}

void vista_health_judge(const vista_frame_view *frame, const vista_cells *cells, vista_health *health,
                        double *valid_fraction) {
  const vista_health_params *const params = &frame->params->health;
  const vista_disparity_image *const disparity = &frame->words;
  const vista_motion *const motion = &frame->motion;
  const bool noisy = frame->noise.sigma > params->noise_min;
  const counted_words words = count(&frame->matched, noisy, disparity);
  *valid_fraction = (double)words.image / ((double)disparity->width_px * disparity->height_px);
  vista_health h = {.matched_fraction = share(words.matched, words.matched_area),
                    .contrast = contrast_of(frame->foveation, cells, &frame->noise)};
  const double agreeing = noisy ? share(words.agreeing, words.asked) : h.matched_fraction;
  const bool none = fmin(h.matched_fraction, agreeing) < params->blind_fraction;
  const bool few = h.matched_fraction < params->degraded_fraction;
  const bool holds[VISTA_HEALTH_REASON_COUNT] = {
      [VISTA_HEALTH_FEW_DISPARITIES] = few && !none,
      [VISTA_HEALTH_NO_DISPARITIES] = none,
      [VISTA_HEALTH_NO_CONTRAST] = frame->seen && h.contrast < params->contrast_min,
      [VISTA_HEALTH_MOTION_UNKNOWN] = motion->source == VISTA_MOTION_CARRIED_ON,
      [VISTA_HEALTH_POSE_JUMP] = motion->source == VISTA_MOTION_REFUSED || motion->restarted,
      [VISTA_HEALTH_NOISE] = noisy && agreeing < params->degraded_fraction,
      [VISTA_HEALTH_GROUND_UNSEEN] = ground_view(frame, noisy) < params->ground_fraction,
      [VISTA_HEALTH_IMAGE_MISSING] = !frame->seen,
  };
  for (int k = 0; k < VISTA_HEALTH_REASON_COUNT; ++k)
    if (holds[k]) vista_health_add(&h, (vista_health_reason)k);
  *health = h;
}
