/* Along a decision: where its trajectory leads after some time. */
#include <math.h>
#include <stdint.h>

#include "common/numbers.h"
#include "vista/plan.h"

void vista_plan_at(const vista_plan_decision *d, double after_s, vista_plan_setpoint *setpoint) {
  const double at = fmax(after_s / d->step_s, 0.0);
  double last = d->point_count - 1, place = at;
  if (place > last && d->circle_from >= 0) place = d->circle_from + fmod(place - d->circle_from, last - d->circle_from);
  place = fmin(place, last);
  const int32_t k = (int32_t)fmin(floor(place), fmax(last - 1.0, 0.0));
  const vista_plan_setpoint *const a = &d->points[k], *const b = &d->points[k < d->point_count - 1 ? k + 1 : k];
  const double share = place - k;
  *setpoint = *a;
  for (int i = 0; i < 3; ++i) {
    setpoint->position_m[i] += share * (b->position_m[i] - a->position_m[i]);
    setpoint->velocity_m_s[i] += share * (b->velocity_m_s[i] - a->velocity_m_s[i]);
    setpoint->acceleration_m_s2[i] += share * (b->acceleration_m_s2[i] - a->acceleration_m_s2[i]);
    setpoint->heading[i] += share * (b->heading[i] - a->heading[i]);
  }
  const double length = vista_norm(setpoint->heading);
  for (int i = 0; i < 3; ++i) setpoint->heading[i] /= length;
}
