#include "detector/findings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "health/health.h"

#define SAMPLE_STEP_PX 4
#define MOTION_REASONS (UINT32_C(1) << VISTA_HEALTH_POSE_JUMP) /* named with those of the motion */
#define MIN_CONTRAST 3.0 /* grey levels, standard deviation */

typedef struct greys {
  double mean, deviation;
} greys;

static greys greys_of(const vista_image *image) {
  double count = 0.0, sum = 0.0, squares = 0.0;
  for (int32_t v = 0; v < image->height_px; v += SAMPLE_STEP_PX)
    for (int32_t u = 0; u < image->width_px; u += SAMPLE_STEP_PX) {
      const double grey = image->data[v * image->stride + u];
      count += 1.0;
      sum += grey;
      squares += grey * grey;
    }
  const double mean = sum / count;
  return (greys){mean, sqrt(fmax(0.0, squares / count - mean * mean))};
}

bool vista_same_image(const vista_image *one, const vista_image *other) {
  for (int32_t v = 0; v < one->height_px; ++v)
    /* NOLINTNEXTLINE(clang-analyzer-core.NonNullParamChecker): whoever asks knows that both have data */
    if (memcmp(one->data + v * one->stride, other->data + v * other->stride, (size_t)one->width_px) != 0) return false;
  return true;
}

void vista_pair_look(vista_pair_view *view, const vista_image *left, const vista_image *right) {
  const vista_image *const sides[2] = {left, right};
  *view = (vista_pair_view){0};
  for (int side = 0; side < 2 && !view->dark; ++side) {
    if (sides[side]->data == NULL) continue;
    const greys seen = greys_of(sides[side]);
    view->dark = seen.deviation < MIN_CONTRAST;
    if (view->dark)
      (void)snprintf(view->text, sizeof view->text, "the %s image is nearly constant: grey level %.0f +- %.1f",
                     side == 0 ? "left" : "right", seen.mean, seen.deviation);
  }
  /* Two cameras never give the same image; a wrong file name or a cable does. */
  view->identical = !view->dark && right->data != NULL && vista_same_image(left, right);
}

static void summarize(vista_detector_result *r) {
  r->health = (vista_line_health){.state = VISTA_HEALTH_HEALTHY};
  for (int32_t k = 0; k < r->finding_count; ++k)
    vista_line_health_add(&r->health, r->findings[k].state, r->findings[k].reason);
}

static int32_t find(const vista_detector_result *r, const char *reason) {
  for (int32_t k = 0; k < r->finding_count; ++k)
    if (strcmp(r->findings[k].reason, reason) == 0) return k;
  return -1;
}

static void append(vista_detector_result *r, vista_health_state state, const char *reason, const char *text) {
  if (r->finding_count == VISTA_LINE_REASONS || find(r, reason) >= 0) return;
  r->findings[r->finding_count++] = (vista_finding){state, reason, text};
}

void vista_detector_add(vista_detector_result *r, const vista_finding *finding) {
  const int32_t there = find(r, finding->reason), at = r->next_finding;
  if (there >= 0 && there < at) return;
  const int32_t end = there >= 0 ? there : r->finding_count;
  if (end == VISTA_LINE_REASONS) return;
  memmove(&r->findings[at + 1], &r->findings[at], (size_t)(end - at) * sizeof r->findings[0]);
  r->findings[at] = *finding;
  r->finding_count += there < 0;
  ++r->next_finding;
  summarize(r);
}

static void append_alignment(const vista_alignment_result *alignment, char *text, vista_detector_result *r) {
  vista_health health = {0};
  vista_alignment_judge(alignment, &health);
  if (health.state == VISTA_HEALTH_HEALTHY) return;
  const bool lost = alignment->state == VISTA_ALIGNMENT_BEYOND || alignment->state == VISTA_ALIGNMENT_LOST;
  if (!lost) {
    (void)snprintf(text, VISTA_FINDING_TEXT, "matching features lie %.1f px apart in rows: has a camera moved?",
                   alignment->row_error_px);
    append(r, health.state, vista_health_reason_name(VISTA_HEALTH_ROWS_MISALIGNED), text);
    return;
  }
  append(r, health.state, vista_health_reason_name(VISTA_HEALTH_ALIGNMENT_LOST),
         alignment->state == VISTA_ALIGNMENT_BEYOND
             ? "the right camera has turned against its calibration by more than is corrected: has a camera moved?"
             : "the images have texture, but their rows agree on no turn of the right camera: has a camera moved?");
}

static void append_watched(uint32_t reasons, vista_detector_result *r) {
  for (int k = 0; k < VISTA_HEALTH_REASON_COUNT; ++k) {
    const vista_health_reason reason = (vista_health_reason)k;
    if (reasons >> k & 1)
      append(r, vista_health_reason_state(reason), vista_health_reason_name(reason), vista_health_reason_text(reason));
  }
}

static void append_of_pipeline(const vista_health *health, vista_detector_result *r) {
  for (int k = 0; k < VISTA_HEALTH_REASON_COUNT; ++k)
    if (health->reasons >> k & 1)
      append(r, health->state, vista_health_reason_name((vista_health_reason)k),
             vista_health_reason_text((vista_health_reason)k));
}

void vista_findings_of(const vista_frame_facts *facts, vista_detector_result *r) {
  const vista_rig *const rig = facts->rig;
  r->finding_count = 0;
  r->shown = !facts->view->dark && !facts->view->identical;
  if (rig->baseline_problem != NULL) append(r, VISTA_HEALTH_DEGRADED, "baseline_implausible", rig->baseline_problem);
  if (rig->calibration_problem != NULL)
    append(r, VISTA_HEALTH_DEGRADED, "calibration_misfit", rig->calibration_problem);
  if (facts->view->dark)
    append(r, VISTA_HEALTH_BLIND, vista_health_reason_name(VISTA_HEALTH_NO_CONTRAST), facts->view->text);
  else if (facts->view->identical)
    append(r, VISTA_HEALTH_BLIND, "images_identical", "the left and the right image are identical");
  append_alignment(&r->alignment, facts->text, r);
  append_watched(facts->watched & ~MOTION_REASONS, r);
  r->next_finding = r->finding_count;
  if (facts->motion_unknown)
    append(r, VISTA_HEALTH_DEGRADED, vista_health_reason_name(VISTA_HEALTH_MOTION_UNKNOWN),
           "no poses are given: tracks and warnings mean little");
  if (facts->began_anew)
    append(r, VISTA_HEALTH_DEGRADED, vista_health_reason_name(VISTA_HEALTH_POSE_JUMP),
           "the poses began anew; all tracks were dropped");
  append_watched(facts->watched & MOTION_REASONS, r);
  append_of_pipeline(&r->result.health, r);
  summarize(r);
}
