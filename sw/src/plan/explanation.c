#include "vista/plan.h"

static const char *name_of(const char *const *names, int count, unsigned value) {
  return value < (unsigned)count ? names[value] : "unknown";
}

const char *vista_plan_action_name(vista_plan_action action) {
  static const char *const names[VISTA_PLAN_ACTION_COUNT] = {"proceeds", "evades",  "escapes",
                                                             "holds",    "arrived", "helpless"};
  return name_of(names, VISTA_PLAN_ACTION_COUNT, (unsigned)action);
}

const char *vista_plan_primitive_name(vista_plan_primitive primitive) {
  static const char *const names[VISTA_PLAN_PRIMITIVE_COUNT] = {"straight", "arc",  "climb",
                                                                "descent",  "stop", "loiter"};
  return name_of(names, VISTA_PLAN_PRIMITIVE_COUNT, (unsigned)primitive);
}

const char *vista_plan_ruling_name(vista_plan_ruling ruling) {
  static const char *const names[VISTA_PLAN_RULING_COUNT] = {"chosen",     "not_asked", "by_obstacle", "by_place",
                                                             "by_unknown", "by_view",   "by_dynamics"};
  return name_of(names, VISTA_PLAN_RULING_COUNT, (unsigned)ruling);
}
