/* What is wrong with a frame, in the order in which it is named. Internal to libvista. */
#ifndef VISTA_SRC_FINDINGS_H
#define VISTA_SRC_FINDINGS_H

#include <stdint.h>

#include "vista/detector.h"

#define VISTA_FINDING_TEXT 128

/* What a pair of raw images shows. */
typedef struct vista_pair_view {
  bool dark;      /* an image is nearly of one grey level */
  bool identical; /* both images are the same */
  char text[VISTA_FINDING_TEXT];
} vista_pair_view;

/* right: without data it is not looked at. */
void vista_pair_look(vista_pair_view *view, const vista_image *left, const vista_image *right);

/* What is known of a frame besides the result of the pipeline. */
typedef struct vista_frame_facts {
  const vista_rig *rig;
  const vista_pair_view *view;
  bool motion_unknown, began_anew;
  uint32_t watched; /* reasons that the watch gives */
  char *text; /* VISTA_FINDING_TEXT bytes for what the alignment says */
} vista_frame_facts;

/* Fills the findings of a result whose other members are set. */
void vista_findings_of(const vista_frame_facts *facts, vista_detector_result *result);

bool vista_same_image(const vista_image *one, const vista_image *other);

#endif
