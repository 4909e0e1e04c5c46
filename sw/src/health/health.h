/* Does the view tell anything, and does the detector know where it is?
 *
 * Without disparities nothing is found, and an empty list of obstacles says nothing: a lens cap, fog, the inside of a
 * cloud, the night. Such a frame is BLIND. DEGRADED is one that was seen in part, or whose place in the world rests on
 * a guess. Noise must not pass for something seen: in a noisy image those disparities count that another one agrees
 * with (agreement.h), which chance does not bring about. The contrast is that of the cells, which average the noise of
 * the sensor away, less what is left of it. A frame is degraded, too, where the ground ahead is not seen. */
#ifndef VISTA_HEALTH_H
#define VISTA_HEALTH_H

#include "perceive/cells/cells.h"
#include "perceive/frame_view.h"
#include "vista/obstacle.h"

/* valid_fraction: of the whole image's pixels, those that have a disparity. */
void vista_health_judge(const vista_frame_view *frame, const vista_cells *cells, vista_health *health,
                        double *valid_fraction);

/* Adds a reason; the state becomes the worse one of both. */
void vista_health_add(vista_health *health, vista_health_reason reason);

/* How bad a frame is that has this reason and no other. */
vista_health_state vista_health_reason_state(vista_health_reason reason);

#endif
