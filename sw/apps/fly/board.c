/* The two sensors of a board as a source: it rectifies and matches their pairs, and the words come without images. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clock.h"
#include "source.h"
#include "vista/board.h"

#define AGAIN_NS FLY_SECOND
#define HOST_BYTES 256

typedef struct sensors {
  vista_board *board;
  void *memory; /* of the board */
  const char *name;
  vista_board_settings settings;
  bool taken; /* the board has a session of ours, and takes pairs */
  bool quiet; /* it answers, and no pair comes */
  bool begins; /* the next pair is the first of a session */
} sensors;

static vista_board_settings settings_of(const container *c) {
  const vista_stereo_params *const stereo = &c->parameters.stereo;
  return (vista_board_settings){.width_px = c->rig.camera.width_px,
                                .height_px = c->rig.camera.height_px,
                                .xsobel = stereo->prefilter == VISTA_STEREO_PREFILTER_XSOBEL,
                                .prefilter_cap = stereo->prefilter_cap,
                                .texture_threshold = stereo->texture_threshold,
                                .uniqueness_ratio = stereo->uniqueness_ratio,
                                .lr_max_diff = stereo->lr_max_diff,
                                .smooth = stereo->smooth == VISTA_STEREO_SMOOTH_BINOMIAL3,
                                .levels = stereo->levels,
                                .cameras = 1,
                                .left_map = c->rig.tables[0].grid,
                                .right_map = c->rig.tables[1].grid};
}

/* Whether the board was built for what the rig asks of it. */
static bool fits(const sensors *own, const container *c, problem *p) {
  const vista_stereo_params *const stereo = &c->parameters.stereo;
  vista_board_build build;
  const vista_status status = vista_board_identify(own->board, &build);
  if (status != VISTA_OK) return problem_say(p, own->name, "%s", vista_status_text(status));
  if (build.cameras == 0) return problem_say(p, own->name, "the board was built without sensors of its own");
  if (build.num_disparities != stereo->num_disparities || build.block_size != stereo->block_size)
    return problem_say(
        p, own->name, "the board was built for %d disparities and blocks of %d px, the rig for %d and %d",
        (int)build.num_disparities, (int)build.block_size, (int)stereo->num_disparities, (int)stereo->block_size);
  return c->rig.tables[0].whole == NULL ||
         problem_say(p, own->name,
                     "stereo.rectify_rows of the rig is 0: the board has to rectify what its sensors see");
}

static vista_status begin(sensors *own) {
  vista_status status = vista_board_configure(own->board, &own->settings);
  if (status == VISTA_OK) status = vista_board_start(own->board);
  own->taken = own->begins = status == VISTA_OK;
  return status;
}

static void say(const sensors *own, const char *text) {
  dprintf(STDERR_FILENO, "vista-fly: %s: %s\n", own->name, text);
}

static void lose(sensors *own, vista_status status) {
  dprintf(STDERR_FILENO, "vista-fly: %s: %s; trying to set it up again\n", own->name, vista_status_text(status));
  own->taken = false;
}

static void hand_over(source *s, const vista_board_pair *pair, shot *to) {
  sensors *const own = s->own;
  to->index = pair->number;
  to->t_ns = pair->t_ns;
  to->exposed_ns = pair->came_ns;
  to->continues = !own->begins;
  to->has_pose = to->has_up = to->anew = false;
  to->words_alone = true;
  own->begins = own->quiet = false;
  mailbox_put(s->box);
}

static void receive(source *s) {
  sensors *const own = s->own;
  shot *const to = mailbox_blank(s->box);
  vista_board_pair pair;
  const vista_status status = vista_board_receive(own->board, to->words, vista_board_words(own->board), &pair);
  const vista_board_counts counts = vista_board_count(own->board);
  atomic_store(&s->skipped, counts.lost + counts.refused_left + counts.refused_right);
  if (status == VISTA_OK) {
    hand_over(s, &pair, to);
  } else if (status != VISTA_ERROR_FRAME) {
    lose(own, status);
  } else if (!own->quiet) {
    say(own, "answers, but no pair of its sensors comes");
    own->quiet = true;
  }
}

static bool run(source *s) {
  sensors *const own = s->own;
  while (!atomic_load(&s->stopped)) {
    const int64_t now_ns = fly_now_ns();
    atomic_store(&s->alive_ns, now_ns);
    if (own->taken) {
      receive(s);
    } else if (fly_sleep_until(now_ns + AGAIN_NS, &s->stopped) && begin(own) == VISTA_OK) {
      say(own, "back");
    }
  }
  return true;
}

static void close_board(source *s) {
  sensors *const own = s->own;
  vista_board_disconnect(own->board);
  free(own->memory);
  free(own);
}

/* ADDRESS or ADDRESS:PORT. */
static bool split(const char *name, char host[HOST_BYTES], int32_t *port) {
  const size_t length = strcspn(name, ":");
  char *end = NULL;
  if (length == 0 || length >= HOST_BYTES) return false;
  memcpy(host, name, length);
  host[length] = '\0';
  *port = VISTA_BOARD_PORT;
  if (name[length] == '\0') return true;
  const long number = strtol(name + length + 1, &end, 10);
  *port = (int32_t)number;
  return name[length + 1] != '\0' && *end == '\0' && number >= 1 && number <= UINT16_MAX;
}

bool source_open_board(source *s, const char *name, const container *c, int32_t silent_ms, problem *p) {
  static const source_kind kind = {run, close_board};
  sensors *const own = calloc(1, sizeof *own);
  if (own == NULL) return problem_say(p, name, "out of memory");
  own->memory = malloc(vista_board_bytes());
  own->name = name;
  own->settings = settings_of(c);
  s->kind = &kind;
  s->own = own;
  if (own->memory == NULL) return problem_say(p, name, "out of memory");
  char host[HOST_BYTES];
  int32_t port;
  if (!split(name, host, &port)) return problem_say(p, name, "is not ADDRESS or ADDRESS:PORT");
  vista_status status = vista_board_connect(own->memory, vista_board_bytes(), host, port, silent_ms, &own->board);
  if (status == VISTA_OK && !fits(own, c, p)) return false;
  if (status == VISTA_OK) status = begin(own);
  return status == VISTA_OK || problem_say(p, name, "%s", vista_status_text(status));
}
