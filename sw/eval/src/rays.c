#include "rays.h"

#include <dlfcn.h>
#include <stdalign.h>
#include <string.h>

/* What is called of Embree 4, as its manual has it; the package has no headers. */
enum { LANES = 16, TRIANGLES = 0, INDICES = 0, VERTICES = 1, THREE_UINT = 0x5003, THREE_FLOAT = 0x9003 };
enum { COHERENT = 1 << 16 };
static const uint32_t NONE = UINT32_MAX, EVERY_FEATURE = UINT32_MAX;
static const float FAR = 1e37f;

typedef struct packet_rays {
  alignas(64) float origin[3][LANES];
  float nearest[LANES], direction[3][LANES], time[LANES], farthest[LANES];
  uint32_t mask[LANES], id[LANES], flags[LANES];
} packet_rays;

typedef struct packet {
  packet_rays rays;
  float normal[3][LANES], second[LANES], third[LANES];
  uint32_t face[LANES], mesh[LANES], instances[2][LANES];
} packet;

typedef struct query {
  int32_t flags;
  uint32_t features;
  void *context, *filter, *intersect, *reserved;
} query;

typedef void *new_of(const void *);
typedef void *new_geometry(void *device, int kind);
typedef void set_buffer(void *mesh, int kind, unsigned slot, int format, const void *data, size_t offset, size_t stride,
                        size_t count);
typedef unsigned attach(void *scene, void *mesh);
typedef void act_on(void *handle);
typedef void trace(const int32_t *valid, void *scene, void *rays, query *query);

static const query COHERENT_RAYS = {.flags = COHERENT, .features = EVERY_FEATURE};

/* Turns what dlsym gives into a function: the copy is what POSIX asks for. */
#define FUNCTION(kind, name, embree, symbol) \
  kind *name;                                \
  {                                          \
    void *found = dlsym(embree, symbol);     \
    memcpy(&name, &found, sizeof name);      \
  }

bool vista_rays_open(vista_obstructions *o, const char *library, const float *corner_m, size_t corners,
                     const uint32_t *face, size_t faces) {
  *o = (vista_obstructions){.embree = dlopen(library, RTLD_NOW | RTLD_LOCAL)};
  if (!o->embree) return false;
  FUNCTION(new_of, new_device, o->embree, "rtcNewDevice")
  FUNCTION(new_of, new_scene, o->embree, "rtcNewScene")
  FUNCTION(new_geometry, new_mesh, o->embree, "rtcNewGeometry")
  FUNCTION(set_buffer, set, o->embree, "rtcSetSharedGeometryBuffer")
  FUNCTION(attach, put_into, o->embree, "rtcAttachGeometry")
  FUNCTION(act_on, commit_mesh, o->embree, "rtcCommitGeometry")
  FUNCTION(act_on, release_mesh, o->embree, "rtcReleaseGeometry")
  FUNCTION(act_on, commit, o->embree, "rtcCommitScene")
  o->device = new_device("threads=1");
  if (!o->device) return false;
  o->scene = new_scene(o->device);
  void *mesh = new_mesh(o->device, TRIANGLES);
  set(mesh, VERTICES, 0, THREE_FLOAT, corner_m, 0, 3 * sizeof *corner_m, corners);
  set(mesh, INDICES, 0, THREE_UINT, face, 0, 3 * sizeof *face, faces);
  commit_mesh(mesh);
  put_into(o->scene, mesh);
  release_mesh(mesh);
  commit(o->scene);
  return true;
}

void vista_rays_close(vista_obstructions *o) {
  if (!o->embree) return;
  FUNCTION(act_on, release_scene, o->embree, "rtcReleaseScene")
  FUNCTION(act_on, release_device, o->embree, "rtcReleaseDevice")
  if (o->scene) release_scene(o->scene);
  if (o->device) release_device(o->device);
  *o = (vista_obstructions){0};
}

static void set_lane(packet_rays *rays, size_t lane, const float origin_m[3], const float direction[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    rays->origin[axis][lane] = origin_m[axis];
    rays->direction[axis][lane] = direction[axis];
  }
  rays->nearest[lane] = rays->time[lane] = 0.0f;
  rays->farthest[lane] = FAR;
  rays->mask[lane] = NONE;
  rays->id[lane] = rays->flags[lane] = 0;
}

size_t vista_rays_met(const vista_obstructions *o, const vista_rays *rays, const int64_t *order, size_t count,
                      const vista_hits *hits) {
  FUNCTION(trace, intersect, o->embree, "rtcIntersect16")
  query coherent = COHERENT_RAYS;
  size_t found = 0;
  for (size_t first = 0; first < count; first += LANES) {
    const size_t used = count - first < LANES ? count - first : LANES;
    packet p = {0};
    alignas(64) int32_t valid[LANES] = {0};
    for (size_t lane = 0; lane < used; ++lane) {
      valid[lane] = -1;
      set_lane(&p.rays, lane, rays->origin_m, rays->direction + 3 * order[first + lane]);
      p.mesh[lane] = NONE;
    }
    intersect(valid, o->scene, &p, &coherent);
    for (size_t lane = 0; lane < used; ++lane) {
      if (p.mesh[lane] == NONE) continue;
      hits->ray[found] = order[first + lane];
      hits->depth_m[found] = p.rays.farthest[lane];
      hits->face[found] = (int32_t)p.face[lane];
      hits->second[found] = p.second[lane];
      hits->third[found] = p.third[lane];
      ++found;
    }
  }
  return found;
}

void vista_rays_hide(const vista_obstructions *o, size_t count, const float *point_m, const float *normal,
                     float above_m, const float towards[3], bool *reached) {
  FUNCTION(trace, occluded, o->embree, "rtcOccluded16")
  query coherent = COHERENT_RAYS;
  for (size_t next = 0; next < count;) {
    packet_rays rays = {0};
    alignas(64) int32_t valid[LANES] = {0};
    size_t point[LANES], used = 0;
    for (; next < count && used < LANES; ++next) {
      if (!reached[next]) continue;
      float start_m[3];
      for (int axis = 0; axis < 3; ++axis) start_m[axis] = point_m[3 * next + axis] + above_m * normal[3 * next + axis];
      set_lane(&rays, used, start_m, towards);
      valid[used] = -1;
      point[used++] = next;
    }
    occluded(valid, o->scene, &rays, &coherent);
    for (size_t lane = 0; lane < used; ++lane) reached[point[lane]] = !(rays.farthest[lane] < 0.0f);
  }
}
