/* The link to the autopilot, in a thread of its own: it hears of us 10 times a second whatever the frames do, and we of
 * the vehicle's motion. */
#ifndef VISTA_FLY_AUTOPILOT_H
#define VISTA_FLY_AUTOPILOT_H

#include <pthread.h>
#include <stdatomic.h>

#include "problem.h"
#include "transport.h"
#include "vista/detector.h"
#include "vista/latency.h"
#include "vista/mavlink.h"
#include "vista/vehicle.h"

#define AUTOPILOT_OBSTACLES 64

/* The place of the camera at the time of a frame. Members as in vista_detector_place. */
typedef struct placement {
  bool has_pose, has_up, has_velocity;
  vista_pose pose; /* of the rectified left camera */
  double up_world[3], velocity_m_s[3];
} placement;

typedef struct autopilot {
  pthread_t thread;
  bool running;
  pthread_mutex_t lock; /* of link, vehicle and latency */
  vista_mavlink link;
  vista_vehicle vehicle;
  transport way;
  vista_latency told; /* from the exposure until the first distances that tell of it are handed over */
  int64_t untold_ns; /* when the frame was exposed that no message has told of; 0: none */
  int64_t sent;
  atomic_bool stopped;
  atomic_llong alive_ns;
} autopilot;

/* a: of zeros. */
bool autopilot_open(autopilot *a, const char *target, int listen_port, int64_t delay_ns,
                    const vista_mavlink_params *params, problem *p);
bool autopilot_start(autopilot *a, problem *p);

/* What a frame found that was exposed at that moment. */
void autopilot_tell(autopilot *a, const vista_detector_result *found, int64_t exposed_ns);

/* Says where the camera was at a moment, as far as the autopilot has said. speed_max_m_s: a faster vehicle has no velocity. */
void autopilot_place(autopilot *a, int64_t exposed_ns, double speed_max_m_s, placement *where);

/* How the vehicle moves now, as far as the autopilot has said; and whether it flies setpoints. */
bool autopilot_motion(autopilot *a, int64_t now_ns, vista_vehicle_motion *motion);

/* Hands a decision over whose state was that of this moment. */
void autopilot_fly(autopilot *a, const vista_plan_decision *decision, int64_t state_ns);

/* Ends the thread. */
void autopilot_stop(autopilot *a);

void autopilot_close(autopilot *a);

#endif
