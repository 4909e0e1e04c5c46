#include "link/board/session.h"

#include <stddef.h>

#include "link/board/request.h"
#include "vista_stereo_csr.h"

#define ADDRESS(name) ((uint32_t)offsetof(vista_stereo_csr_t, name))
#define FIELD(name, value) (((uint32_t)(value) << VISTA_STEREO_CSR__##name##_bp) & VISTA_STEREO_CSR__##name##_bm)
#define READ_FIELD(data, name) (((data) & VISTA_STEREO_CSR__##name##_bm) >> VISTA_STEREO_CSR__##name##_bp)

enum {
  BUILD_REGISTERS = 4, /* ID, VERSION, BUILD, BUILD_SIZE */
  GRID_STEP_PX = 16,   /* from one control point to the next */
  MIN_WIDTH_PX = 4,
  MIN_HEIGHT_PX = 2,
  MAX_CAP = 63,
  MAX_PERCENT = 100,
  /* More than any sum of texture and any difference of disparities: the registers hold no larger numbers. */
  MAX_TEXTURE = 0xFFFF,
  MAX_DIFF_PX = 0xFF,
  OPEN_TRIES = 3, /* against others who open a session at the same moment */
};

static const uint32_t map_errors = VISTA_STEREO_CSR__ERRORS__MAP_ROWS_bm | VISTA_STEREO_CSR__ERRORS__MAP_SIZE_bm;

vista_status session_identify(vista_board *board, vista_board_build *build) {
  uint32_t value[BUILD_REGISTERS], front_end;
  vista_status status = request_read(board, ADDRESS(ID), value, BUILD_REGISTERS);
  if (status == VISTA_OK) status = request_read(board, ADDRESS(BUILD_FRONT_END), &front_end, 1);
  if (status != VISTA_OK) return status;
  const uint32_t major = READ_FIELD(value[1], VERSION__MAJOR);
  if (value[0] != VISTA_STEREO_CSR__ID__MAGIC_reset || major != VISTA_STEREO_CSR__VERSION__MAJOR_reset)
    return VISTA_ERROR_BOARD;
  *build = (vista_board_build){
      .version_major = (int32_t)major,
      .version_minor = (int32_t)READ_FIELD(value[1], VERSION__MINOR),
      .num_disparities = (int32_t)READ_FIELD(value[2], BUILD__NUM_DISPARITIES),
      .block_size = (int32_t)READ_FIELD(value[2], BUILD__BLOCK_SIZE),
      .max_width_px = (int32_t)READ_FIELD(value[3], BUILD_SIZE__MAX_WIDTH),
      .max_height_px = (int32_t)READ_FIELD(value[3], BUILD_SIZE__MAX_HEIGHT),
      .max_pixels = WIRE_MAX_CHUNKS_IN * CHUNK_PIXELS,
      .rectify_rows = (int32_t)READ_FIELD(front_end, BUILD_FRONT_END__RECTIFY_ROWS),
      .map_points = (int32_t)READ_FIELD(front_end, BUILD_FRONT_END__MAP_POINTS),
      .cameras = (int32_t)board->status.cameras,
  };
  return VISTA_OK;
}

static bool in_range(int32_t value, int32_t least, int32_t most) { return value >= least && value <= most; }

static int64_t map_points(const vista_board_settings *settings) {
  const int64_t columns = (settings->width_px + GRID_STEP_PX - 1) / GRID_STEP_PX + 1;
  return columns * ((settings->height_px + GRID_STEP_PX - 1) / GRID_STEP_PX + 1);
}

static bool rectifies(const vista_board_settings *settings) { return settings->left_map != NULL; }

vista_status session_check(const vista_board_settings *settings, const vista_board_build *build) {
  if ((settings->left_map == NULL) != (settings->right_map == NULL)) return VISTA_ERROR_ARGUMENT;
  const bool sound = in_range(settings->xsobel, 0, 1) && in_range(settings->prefilter_cap, 1, MAX_CAP) &&
                     settings->texture_threshold >= 0 && in_range(settings->uniqueness_ratio, 0, MAX_PERCENT) &&
                     settings->lr_max_diff >= -1 && in_range(settings->smooth, 0, 1) &&
                     in_range(settings->cameras, 0, 1) && in_range(settings->levels, 1, LAYOUT_MAX_LEVELS);
  if (!sound) return VISTA_ERROR_RANGE;
  if (settings->cameras > build->cameras) return VISTA_ERROR_BOARD;
  const bool fits = in_range(settings->width_px, MIN_WIDTH_PX, build->max_width_px) &&
                    in_range(settings->height_px, MIN_HEIGHT_PX, build->max_height_px) &&
                    (int64_t)settings->width_px * settings->height_px <= build->max_pixels;
  if (!fits || (rectifies(settings) && map_points(settings) > build->map_points)) return VISTA_ERROR_SIZE;
  const frame_layout layout = frame_layout_of(settings->width_px, settings->height_px, settings->levels);
  return layout.pairs <= (int64_t)WIRE_MAX_CHUNKS_OUT * CHUNK_WORDS ? VISTA_OK : VISTA_ERROR_SIZE;
}

/* A number that is neither that of the session in force nor likely that of another client's. */
static uint32_t new_session(uint32_t previous) {
  const uint32_t session = (uint32_t)((uint64_t)connection_now_ns() * 0x9E3779B97F4A7C15u >> 32);
  return session == 0 || session == previous ? previous + 1 + (previous + 1 == 0) : session;
}

vista_status session_wait_until_idle(vista_board *board) {
  const int64_t begin_ns = connection_now_ns();
  vista_status status = VISTA_OK;
  while (status == VISTA_OK && board->status.busy)
    status = request_has_waited(board, begin_ns) ? VISTA_ERROR_FRAME : request_status(board, 0);
  return status;
}

vista_status session_open(vista_board *board, const vista_board_settings *settings) {
  board->counts.lost += board->waiting_count;
  board->session = board->writes = board->next_frame = 0;
  board->waiting_count = 0;
  board->cameras = settings->cameras;
  vista_status status = request_status(board, 0);
  for (int32_t i = 0; i < OPEN_TRIES && status == VISTA_OK; i++) {
    const uint32_t previous = board->status.session, session = new_session(previous);
    const int32_t body = WIRE_HEADER_WORDS;
    packet *const out = &board->out;
    connection_begin(board, WIRE_REQUEST_OPEN, 0, WIRE_OPEN_WORDS);
    packet_set_field(out, 0, WIRE_HEADER_SESSION, session);
    packet_set_field(out, body, WIRE_OPEN_PREVIOUS, previous);
    packet_set_field(out, body, WIRE_OPEN_WIDTH, (uint32_t)settings->width_px);
    packet_set_field(out, body, WIRE_OPEN_HEIGHT, (uint32_t)settings->height_px);
    const int64_t pixels = settings->cameras ? 0 : (int64_t)settings->width_px * settings->height_px;
    packet_set_field(out, body, WIRE_OPEN_CHUNKS_IN, (uint32_t)((pixels + CHUNK_PIXELS - 1) / CHUNK_PIXELS));
    packet_set_field(out, body, WIRE_OPEN_WORDS_OUT, (uint32_t)board->layout.pairs);
    status = request_reply(board, WIRE_REPLY_STATUS);
    if (status == VISTA_OK && board->status.session != session && board->status.held) return VISTA_ERROR_HELD;
    if (status != VISTA_OK || board->status.session != session) continue;
    board->session = session;
    board->session_token = board->status.token;
    return session_wait_until_idle(board);
  }
  return status == VISTA_OK ? VISTA_ERROR_SESSION : status;
}

void session_close(vista_board *board) {
  if (board->session == 0) return;
  connection_begin(board, WIRE_REQUEST_CLOSE, 0, 0);
  connection_send(board);
  board->session = 0;
}

static vista_status load_points(vista_board *board, const int16_t *points, int64_t count) {
  vista_status status = VISTA_OK;
  for (int64_t i = 0; i < count && status == VISTA_OK; i += CHUNK_WORDS) {
    uint32_t value[CHUNK_WORDS];
    const int32_t now = count - i < CHUNK_WORDS ? (int32_t)(count - i) : CHUNK_WORDS;
    for (int32_t j = 0; j < now; j++) {
      const int16_t *const point = points + 2 * (i + j);
      value[j] = FIELD(MAP_POINT__DX, (uint16_t)point[0]) | FIELD(MAP_POINT__DY, (uint16_t)point[1]);
    }
    /* cppcheck-suppress uninitvar ; as many as are sent were set */
    status = request_write(board, ADDRESS(MAP_POINT), value, now);
  }
  return status;
}

static vista_status load_map(vista_board *board, const vista_board_settings *settings) {
  const uint32_t begin = FIELD(MAP__BEGIN_LOAD, 1), commit = FIELD(COMMIT__MAP, 1);
  uint32_t ready = 0, errors = 0;
  vista_status status = request_read(board, ADDRESS(MAP), &ready, 1);
  if (status == VISTA_OK && !READ_FIELD(ready, MAP__READY)) return VISTA_ERROR_FRAME; /* no frame is inside */
  if (status == VISTA_OK) status = request_write(board, ADDRESS(MAP), &begin, 1);
  if (status == VISTA_OK) status = load_points(board, settings->left_map, map_points(settings));
  if (status == VISTA_OK) status = load_points(board, settings->right_map, map_points(settings));
  if (status == VISTA_OK) status = request_write(board, ADDRESS(COMMIT), &commit, 1);
  if (status == VISTA_OK) status = request_read(board, ADDRESS(ERRORS), &errors, 1);
  if (status != VISTA_OK || !(errors & map_errors)) return status;
  return READ_FIELD(errors, ERRORS__MAP_ROWS) ? VISTA_ERROR_CAPACITY : VISTA_ERROR_SIZE;
}

typedef struct register_value {
  uint32_t address, value;
} register_value;

static vista_status write_all(vista_board *board, const register_value *list, int32_t count) {
  vista_status status = VISTA_OK;
  for (int32_t i = 0; i < count && status == VISTA_OK; i++)
    status = request_write(board, list[i].address, &list[i].value, 1);
  return status;
}

vista_status session_set_up(vista_board *board, const vista_board_settings *settings) {
  const int32_t texture = settings->texture_threshold < MAX_TEXTURE ? settings->texture_threshold : MAX_TEXTURE;
  const int32_t max_diff = settings->lr_max_diff < MAX_DIFF_PX ? settings->lr_max_diff : MAX_DIFF_PX;
  const register_value before[] = {
      {ADDRESS(CONTROL), FIELD(CONTROL__SOFT_RESET, 1)},
      {ADDRESS(ERRORS), ~0u},
      {ADDRESS(SIZE), FIELD(SIZE__WIDTH, settings->width_px) | FIELD(SIZE__HEIGHT, settings->height_px)},
      {ADDRESS(PREFILTER), FIELD(PREFILTER__XSOBEL, settings->xsobel) | FIELD(PREFILTER__CAP, settings->prefilter_cap)},
      {ADDRESS(TEXTURE), FIELD(TEXTURE__THRESHOLD, texture)},
      {ADDRESS(UNIQUENESS), FIELD(UNIQUENESS__RATIO, settings->uniqueness_ratio)},
      {ADDRESS(LR_CHECK),
       FIELD(LR_CHECK__ENABLE, settings->lr_max_diff >= 0) | FIELD(LR_CHECK__MAX_DIFF, max_diff < 0 ? 0 : max_diff)},
      {ADDRESS(OUTPUT), FIELD(OUTPUT__NARROW, 1)},
      {ADDRESS(FRONT_END), FIELD(FRONT_END__SMOOTH, settings->smooth) | FIELD(FRONT_END__LEVELS, settings->levels) |
                               FIELD(FRONT_END__RECTIFY, rectifies(settings))},
  };
  const register_value after[] = {{ADDRESS(COMMIT), FIELD(COMMIT__COMMIT, 1)},
                                  {ADDRESS(CONTROL), FIELD(CONTROL__ENABLE, 1)}};
  vista_status status = write_all(board, before, (int32_t)(sizeof before / sizeof before[0]));
  if (status == VISTA_OK && rectifies(settings)) status = load_map(board, settings);
  if (status == VISTA_OK) status = write_all(board, after, (int32_t)(sizeof after / sizeof after[0]));
  return status;
}
