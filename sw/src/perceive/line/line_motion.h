/* The disparity along a thin line of the image, from the camera's own motion; internal to libvista.
 *
 * Along a row of the image a level line looks the same everywhere, and where a block holds a wire and much of what is
 * behind, words are of what is behind: then the two cameras say nothing of a line. The camera's way does. A point of
 * the line that has the disparity d lies in each past view at one place, and there is a line through it again if d is
 * right. For all disparities, each point of the line is looked for in all past views at once (multiple-baseline stereo
 * in inverse distance, Okutomi and Kanade, PAMI 1993), so that what repeats in one of them is told apart by the others.
 * Where the camera flies straight at a point, it stays where it is in the image, whatever its disparity; then this says
 * nothing either. What moves by itself is taken for standing. */
#ifndef VISTA_LINE_MOTION_H
#define VISTA_LINE_MOTION_H

#include <stdint.h>

#include "common/arena.h"
#include "perceive/frame_view.h"
#include "perceive/line/past_views.h"
#include "perceive/line/thin_line.h"

#define VISTA_MOTION_SPACING_PX 4 /* along the line, from one sample to the next, at least, */
#define VISTA_MOTION_SAMPLES 80   /* and so many of a line at most */

/* A pixel along the line, and its disparity. */
typedef struct vista_line_sample {
  float t_px, disparity_px;
} vista_line_sample;

typedef struct vista_line_motion {
  vista_past_views views;
  int32_t samples_left;            /* that may still be looked for, which bounds the time */
  struct vista_line_point *points; /* scratch: of a line */
  float *beside_px;                /* scratch of who asks: of a line */
  int16_t *score; /* scratch: for each of them, of each disparity, how much the views show a line there */
  int16_t *seen;  /* scratch: and how many of them hold the point */
} vista_line_motion;

void vista_line_motion_layout(vista_line_motion *motion, vista_arena *arena, int32_t width_px, int32_t height_px);

/* Before some lines of a frame. */
void vista_line_motion_begin(vista_line_motion *motion);

/* The samples that were asked for, and how well they are known. */
typedef struct vista_moved_samples {
  int32_t asked, count;
  double step_px; /* of disparity, between two hypotheses */
  double per_px; /* of disparity: what a pixel is worth in the view in which the line moves most */
} vista_moved_samples;

/* Coordinate along the line of one of its samples. */
static inline int32_t vista_moved_sample_px(const vista_thin_line *line, int32_t k) {
  const int32_t apart_px = (line->last_px - line->first_px) / VISTA_MOTION_SAMPLES + 1;
  const int32_t spacing_px = apart_px > VISTA_MOTION_SPACING_PX ? apart_px : VISTA_MOTION_SPACING_PX;
  return line->first_px + spacing_px / 2 + k * spacing_px;
}

/* Fills samples, VISTA_MOTION_SAMPLES at most, in order. beside_px: for each sample, the disparity of what is
 * matched beside the line; negative: nothing is. A line that is of that gets no samples. */
vista_moved_samples vista_line_motion_samples(const vista_frame_view *frame, const vista_thin_line *line,
                                              const float *beside_px, vista_line_motion *motion,
                                              vista_line_sample *samples);

#endif
