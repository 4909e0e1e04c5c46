#include "options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const options_help =
    "usage: vista-fly SOURCE [options]\n"
    "\n"
    "Finds obstacles while the frames come, tells an autopilot of them and writes a line of JSON a frame: what\n"
    "`vista live` does, without Python. `vista prepare` makes its files beforehand.\n"
    "\n"
    "SOURCE is one of:\n"
    "  --camera DEVICE [DEVICE]  left and right camera of V4L2, or one whose picture holds both views side by side\n"
    "  --shared NAME          frames that another process shares (vista/shared_frames.h)\n"
    "  --board ADDRESS[:PORT] the sensors of a board, which matches their pairs: words come, and no images\n"
    "  --recording FILE       frames.vista of `vista prepare`, as fast as they were taken, or what `vista run "
    "--record`\n"
    "                         wrote\n"
    "\n"
    "  --rig FILE             rig.vista of `vista prepare`: cameras and parameters; a recording holds its own\n"
    "  --to TARGET            the autopilot: udp:ADDRESS:PORT or serial:DEVICE[:BAUD]\n"
    "  --listen PORT          the port of UDP to which the autopilot sends\n"
    "  --poses mavlink        poses are what the autopilot says, not what the source says\n"
    "  --pose-delay-ms MS     what its messages take on their way, at least (default 0)\n"
    "  --goal N,E,D           fly to this point of the autopilot's local frame, in metres, while it is in the mode\n"
    "                         OFFBOARD (PX4) or GUIDED (ArduPilot); with --poses mavlink\n"
    "  --speed M_S            fly there at this speed (default 5)\n"
    "  --pair-tolerance-ms MS how far the pictures of two cameras may lie apart (default 5)\n"
    "  --out FILE             append a line for each frame; - is stdout\n"
    "  --repeat               begin again after the last frame of a recording\n"
    "  --all-frames           process each frame of a recording, however long that takes\n"
    "  --frames N             the first N frames of a recording alone\n"
    "  --passes N             play a recording N times\n"
    "  --threads N            threads of the host, in place of what the recording says\n"
    "  --times FILE           the times of all stages of each frame of a recording, as comma-separated values\n"
    "  --watchdog S           end when a thread stands still for so long, to be started again (default 3)\n"
    "  --version, --help\n"
    "\n"
    "exit status:\n"
    "  0    done\n"
    "  2    bad input or usage; one line on stderr names the culprit\n"
    "  3    a thread stood still\n"
    "  130  interrupted (Ctrl-C or SIGTERM); what was written is valid\n";

typedef struct named_text {
  const char *name;
  const char **target;
} named_text;

typedef struct named_number {
  const char *name;
  double least, most, *target;
} named_number;

static bool parse_number(const named_number *number, const char *text, problem *p) {
  char *end = NULL;
  const double value = strtod(text, &end);
  if (end == text || *end != '\0' || !(value >= number->least && value <= number->most))
    return problem_say(p, number->name, "%s is not from %g to %g", text, number->least, number->most);
  *number->target = value;
  return true;
}

static bool take_goal(const char *text, options *o, problem *p) {
  char *end = NULL;
  for (int i = 0; i < 3; ++i, text = end + 1) {
    o->goal_m[i] = strtod(text, &end);
    if (end == text || *end != (i < 2 ? ',' : '\0') || !(fabs(o->goal_m[i]) <= 1e6))
      return problem_say(p, "--goal", "is N,E,D in metres");
  }
  return o->has_goal = true;
}

static bool take_devices(int argc, char *const *argv, int *at, options *o, problem *p) {
  o->camera_count = 0;
  while (*at + 1 < argc && argv[*at + 1][0] != '-') {
    if (o->camera_count == 2) return problem_say(p, "--camera", "takes one device or two");
    o->camera[o->camera_count++] = argv[++*at];
  }
  return o->camera_count > 0 || problem_say(p, "--camera", "takes one device or two");
}

static bool take_flag(const char *name, options *o) {
  if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) return o->want = OPTIONS_HELP, true;
  if (strcmp(name, "--version") == 0) return o->want = OPTIONS_VERSION, true;
  if (strcmp(name, "--repeat") == 0) return o->repeat = true;
  if (strcmp(name, "--all-frames") == 0) return o->all_frames = true;
  return false;
}

/* The option at *at and its value, which it leaves *at on. */
static bool take(int argc, char *const *argv, int *at, options *o, double *listen, problem *p) {
  const char *poses = NULL, *goal = NULL, *const name = argv[*at];
  const named_text texts[] = {{"--rig", &o->rig},     {"--recording", &o->recording},
                              {"--times", &o->times}, {"--shared", &o->shared},
                              {"--board", &o->board}, {"--to", &o->to},
                              {"--out", &o->out},     {"--goal", &goal},
                              {"--poses", &poses}};
  const named_number numbers[] = {{"--pose-delay-ms", 0.0, 1000.0, &o->pose_delay_ms},
                                  {"--pair-tolerance-ms", 0.0, 1000.0, &o->pair_tolerance_ms},
                                  {"--watchdog", 0.5, 3600.0, &o->watchdog_s},
                                  {"--frames", 1.0, 1e6, &o->frames},
                                  {"--passes", 1.0, 1e6, &o->passes},
                                  {"--threads", 1.0, 2.0, &o->threads},
                                  {"--speed", 0.1, 100.0, &o->speed_m_s},
                                  {"--listen", 1.0, 65535.0, listen}};
  if (take_flag(name, o)) return true;
  if (strcmp(name, "--camera") == 0) return take_devices(argc, argv, at, o, p);
  for (size_t k = 0; k < sizeof texts / sizeof texts[0]; ++k) {
    if (strcmp(name, texts[k].name) != 0) continue;
    if (*at + 1 == argc) return problem_say(p, name, "takes a value (see vista-fly --help)");
    *texts[k].target = argv[++*at];
    if (goal != NULL) return take_goal(goal, o, p);
    if (poses != NULL && strcmp(poses, "mavlink") != 0 && strcmp(poses, "source") != 0)
      return problem_say(p, name, "is mavlink or source, not %s", poses);
    if (poses != NULL) o->poses_from_mavlink = strcmp(poses, "mavlink") == 0;
    return true;
  }
  for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; ++k) {
    if (strcmp(name, numbers[k].name) != 0) continue;
    if (*at + 1 == argc) return problem_say(p, name, "takes a value (see vista-fly --help)");
    return parse_number(&numbers[k], argv[++*at], p);
  }
  return problem_say(p, name, "no such option (see vista-fly --help)");
}

static bool check(const options *o, problem *p) {
  const int sources = (o->recording != NULL) + (o->shared != NULL) + (o->board != NULL) + (o->camera_count > 0);
  const char *const of_recordings = o->repeat          ? "--repeat"
                                    : o->all_frames    ? "--all-frames"
                                    : o->times != NULL ? "--times"
                                    : o->frames > 0.0  ? "--frames"
                                    : o->passes > 0.0  ? "--passes"
                                    : o->threads > 0.0 ? "--threads"
                                                       : NULL;
  if (sources != 1) return problem_say(p, "vista-fly", "takes one of --camera, --shared, --board and --recording");
  if (o->rig == NULL && o->recording == NULL)
    return problem_say(p, "--rig", "is needed: vista prepare makes it (see vista-fly --help)");
  if (o->rig != NULL && o->recording != NULL)
    return problem_say(p, "--rig", "is not needed: a recording holds its own");
  if (of_recordings != NULL && o->recording == NULL) return problem_say(p, of_recordings, "goes with --recording");
  if (o->repeat && o->passes > 0.0) return problem_say(p, "--passes", "does not go with --repeat");
  if (o->times != NULL && o->repeat) return problem_say(p, "--times", "goes with --passes, not with --repeat");
  if (o->poses_from_mavlink && o->to == NULL) return problem_say(p, "--poses mavlink", "needs --to");
  if (o->poses_from_mavlink && o->all_frames)
    return problem_say(p, "--poses mavlink", "goes with frames of this moment, not with --all-frames");
  if (o->has_goal && !o->poses_from_mavlink) return problem_say(p, "--goal", "needs --poses mavlink");
  if (o->listen_port > 0 && (o->to == NULL || strncmp(o->to, "udp:", 4) != 0))
    return problem_say(p, "--listen", "goes with --to udp:ADDRESS:PORT");
  return true;
}

bool options_parse(int argc, char *const *argv, options *o, problem *p) {
  double listen = 0.0;
  *o = (options){.pair_tolerance_ms = 5.0, .watchdog_s = 3.0, .speed_m_s = 5.0};
  for (int at = 1; at < argc; ++at) {
    if (!take(argc, argv, &at, o, &listen, p)) return false;
    if (o->want != OPTIONS_FLY) return true;
  }
  if (listen != floor(listen)) return problem_say(p, "--listen", "is no port");
  const double counts[] = {o->frames, o->passes, o->threads};
  for (int k = 0; k < 3; ++k)
    if (counts[k] != floor(counts[k])) return problem_say(p, "vista-fly", "%g is no whole number", counts[k]);
  o->listen_port = (int)listen;
  return check(o, p);
}
