/* Does the view tell anything, and does the detector know where it is?
 *
 * Without disparities nothing is found, and an empty list of obstacles says nothing: a lens cap, fog, the inside of a
 * cloud, the night. Such a frame is BLIND. DEGRADED is one that was seen in part, or whose place in the world rests on
 * a guess. Noise must not pass for something seen: in a noisy image those disparities count that another one agrees
 * with (agreement.h), which chance does not bring about. The contrast is that of the cells, which average the noise of
 * the sensor away, less what is left of it. A frame is degraded, too, where the ground ahead is not seen (ground_view.h). */
#ifndef VISTA_HEALTH_H
#define VISTA_HEALTH_H

#include "common/image_noise.h"
#include "common/matched_area.h"
#include "health/ground_view.h"
#include "perceive/cells/foveation.h"
#include "vista/obstacle.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

/* noise: of the image. valid_fraction: of the whole image's pixels, those that have a disparity. VISTA_ERROR_SIZE: a
 * disparity image of another size; VISTA_ERROR_RANGE: a parameter. */
vista_status vista_health_judge(const vista_health_params *params, const vista_foveation *foveation,
                                const vista_matched_area *matched, const vista_cells *cells,
                                const vista_image_noise *noise, const vista_disparity_image *disparity,
                                const vista_motion *motion, const vista_ahead *ahead, vista_health *health,
                                double *valid_fraction);

#endif
