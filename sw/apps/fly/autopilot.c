#include "autopilot.h"

#include <math.h>
#include <string.h>

#include "clock.h"

#define POLL_MS 5
#define OBSTACLE_DISTANCE 330 /* message ids */
#define OBSTACLE_DISTANCE_3D 11037

bool autopilot_open(autopilot *a, const char *target, int listen_port, int64_t delay_ns,
                    const vista_mavlink_params *params, problem *p) {
  a->way.file = -1;
  (void)pthread_mutex_init(&a->lock, NULL);
  if (vista_mavlink_start(&a->link, params) != VISTA_OK)
    return problem_say(p, "mavlink.angle_offset_deg", "must be a multiple of a sector");
  if (vista_vehicle_start(&a->vehicle, params, delay_ns) != VISTA_OK)
    return problem_say(p, "--pose-delay-ms", "must be from 0 to 1000");
  return transport_open(&a->way, target, listen_port, p);
}

static void note(autopilot *a, const uint8_t *message) {
  const uint32_t id = (uint32_t)message[7] | (uint32_t)message[8] << 8 | (uint32_t)message[9] << 16;
  ++a->sent;
  if ((id != OBSTACLE_DISTANCE && id != OBSTACLE_DISTANCE_3D) || a->untold_ns == 0) return;
  vista_latency_add(&a->told, 1e-6 * (double)(fly_now_ns() - a->untold_ns));
  a->untold_ns = 0;
}

/* The lock is held while a message is made and handed over: neither waits for anything. */
static void send_due(autopilot *a) {
  uint8_t bytes[VISTA_MAVLINK_BYTES];
  int32_t count;
  do {
    count = 0;
    (void)pthread_mutex_lock(&a->lock);
    (void)vista_mavlink_next(&a->link, fly_now_ns(), bytes, (int32_t)sizeof bytes, &count);
    if (count > 0) {
      transport_send(&a->way, bytes, count);
      note(a, bytes);
    }
    (void)pthread_mutex_unlock(&a->lock);
  } while (count > 0);
}

static void *run(void *context) {
  autopilot *const a = context;
  uint8_t bytes[2048];
  while (!atomic_load(&a->stopped)) {
    send_due(a);
    const int32_t count = transport_receive(&a->way, POLL_MS, bytes, (int32_t)sizeof bytes);
    const int64_t now_ns = fly_now_ns();
    (void)pthread_mutex_lock(&a->lock);
    (void)vista_vehicle_receive(&a->vehicle, now_ns, bytes, count);
    (void)pthread_mutex_unlock(&a->lock);
    atomic_store(&a->alive_ns, now_ns);
  }
  return NULL;
}

bool autopilot_start(autopilot *a, problem *p) {
  atomic_store(&a->alive_ns, fly_now_ns());
  a->running = pthread_create(&a->thread, NULL, run, a) == 0;
  return a->running || problem_say(p, "system", "gives no thread");
}

void autopilot_tell(autopilot *a, const vista_detector_result *found, int64_t exposed_ns) {
  vista_mavlink_obstacle obstacles[AUTOPILOT_OBSTACLES];
  vista_mavlink_frame frame;
  if (vista_mavlink_frame_of(&found->result, &found->directions, exposed_ns, obstacles, AUTOPILOT_OBSTACLES, &frame) !=
      VISTA_OK)
    return;
  frame.health = found->health.state;
  frame.reason = found->health.reason_count > 0 ? found->health.reasons[0] : NULL;
  (void)pthread_mutex_lock(&a->lock);
  if (vista_mavlink_update(&a->link, &frame) == VISTA_OK) a->untold_ns = exposed_ns;
  (void)pthread_mutex_unlock(&a->lock);
}

void autopilot_place(autopilot *a, int64_t exposed_ns, double speed_max_m_s, placement *where) {
  vista_vehicle_motion motion;
  (void)pthread_mutex_lock(&a->lock);
  (void)vista_vehicle_at(&a->vehicle, exposed_ns, &motion);
  (void)pthread_mutex_unlock(&a->lock);
  const double *const v = motion.velocity_m_s;
  *where = (placement){.has_pose = motion.pose_known, .has_up = motion.up_known, .pose = motion.pose};
  where->has_velocity = motion.velocity_known && sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) <= speed_max_m_s;
  memcpy(where->velocity_m_s, v, sizeof where->velocity_m_s);
  memcpy(where->up_world, motion.up_world, sizeof where->up_world);
}

bool autopilot_motion(autopilot *a, int64_t now_ns, vista_vehicle_motion *motion) {
  (void)pthread_mutex_lock(&a->lock);
  (void)vista_vehicle_at(&a->vehicle, now_ns, motion);
  const bool follows = vista_vehicle_follows(&a->vehicle, now_ns);
  (void)pthread_mutex_unlock(&a->lock);
  return follows;
}

void autopilot_fly(autopilot *a, const vista_plan_decision *decision, int64_t state_ns) {
  (void)pthread_mutex_lock(&a->lock);
  (void)vista_mavlink_fly(&a->link, decision, state_ns);
  (void)pthread_mutex_unlock(&a->lock);
}

void autopilot_stop(autopilot *a) {
  atomic_store(&a->stopped, true);
  if (a->running) (void)pthread_join(a->thread, NULL);
  a->running = false;
}

void autopilot_close(autopilot *a) {
  autopilot_stop(a);
  transport_close(&a->way);
  (void)pthread_mutex_destroy(&a->lock);
}
