// SPDX-License-Identifier: MIT
#include "bench/yardstick.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "bench/triangulate.h"
#include "rayshade/geometry/trace.h"

namespace rayshade::bench {
namespace {

// Processor time of the process: Embree may build in threads of its own.
double now() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Ray ray_of(float ox, float oy, float oz, float dx, float dy, float dz) {
  Ray ray;
  ray.origin = {ox, oy, oz};
  ray.direction = {dx, dy, dz};
  return ray;
}

void bounds(const RTCBoundsFunctionArguments* a) {
  const auto& user = *static_cast<const UserGeometry*>(a->geometryUserPtr);
  const Bounds3 box = user.scene->leaf_bounds((*user.leaves)[a->primID], user.scene->shutter, 0);
  const auto down = [](double x) {
    return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
  };
  const auto up = [](double x) {
    return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
  };
  *a->bounds_o = {down(box.lo.x), down(box.lo.y), down(box.lo.z), 0,
                  up(box.hi.x),   up(box.hi.y),   up(box.hi.z),   0};
}

void intersect(const RTCIntersectFunctionNArguments* a) {
  const auto& user = *static_cast<const UserGeometry*>(a->geometryUserPtr);
  RTCRayN* rays = RTCRayHitN_RayN(a->rayhit, a->N);
  RTCHitN* hits = RTCRayHitN_HitN(a->rayhit, a->N);
  for (unsigned i = 0; i < a->N; ++i) {
    if (a->valid[i] == 0) continue;
    const Ray ray =
        ray_of(RTCRayN_org_x(rays, a->N, i), RTCRayN_org_y(rays, a->N, i), RTCRayN_org_z(rays, a->N, i),
               RTCRayN_dir_x(rays, a->N, i), RTCRayN_dir_y(rays, a->N, i), RTCRayN_dir_z(rays, a->N, i));
    Hit hit;
    if (!exact_nearest(*user.scene, (*user.leaves)[a->primID], ray, RTCRayN_tnear(rays, a->N, i),
                       RTCRayN_tfar(rays, a->N, i), 0, *user.scratch, hit)) {
      continue;
    }
    RTCRayN_tfar(rays, a->N, i) = static_cast<float>(hit.t());
    RTCHitN_geomID(hits, a->N, i) = a->geomID;
    RTCHitN_primID(hits, a->N, i) = a->primID;
  }
}

void occlude(const RTCOccludedFunctionNArguments* a) {
  const auto& user = *static_cast<const UserGeometry*>(a->geometryUserPtr);
  for (unsigned i = 0; i < a->N; ++i) {
    if (a->valid[i] == 0) continue;
    const Ray ray = ray_of(RTCRayN_org_x(a->ray, a->N, i), RTCRayN_org_y(a->ray, a->N, i),
                           RTCRayN_org_z(a->ray, a->N, i), RTCRayN_dir_x(a->ray, a->N, i),
                           RTCRayN_dir_y(a->ray, a->N, i), RTCRayN_dir_z(a->ray, a->N, i));
    Hit hit;
    if (exact_nearest(*user.scene, (*user.leaves)[a->primID], ray, RTCRayN_tnear(a->ray, a->N, i),
                      RTCRayN_tfar(a->ray, a->N, i), 0, *user.scratch, hit)) {
      RTCRayN_tfar(a->ray, a->N, i) = -std::numeric_limits<float>::infinity();
    }
  }
}

bool count_bytes(void* yardstick, ssize_t bytes, bool /*after*/) {
  static_cast<Yardstick*>(yardstick)->bytes_ += static_cast<std::size_t>(bytes);
  return true;
}

}  // namespace

Yardstick::Yardstick(const CompiledScene& scene, bool robust) : scene_(scene) {
  device_ = rtcNewDevice("threads=1,set_affinity=0");
  rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, this);
  const Group& world = scene.groups[0];
  const TreeCandidates candidates(scene, 0);
  fas::Geometry geometry;
  for (LeafId id = world.first; id < world.first + world.count; ++id) {
    if (id >= world.first + world.unbounded)
      candidates.geometry(id - world.first - world.unbounded, geometry);
    using Form = fas::Geometry::Form;
    if (id < world.first + world.unbounded ||
        (geometry.form != Form::kPoints && geometry.form != Form::kPolygon)) {
      others_.push_back(id);
      continue;
    }
    for (const auto& corner : triangulate(geometry.points)) {
      for (const std::uint32_t k : corner) {
        for (const double x : geometry.points[k]) vertices_.push_back(static_cast<float>(x));
      }
    }
  }
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2; ++i) {
    if (embree_) rtcReleaseScene(embree_);
    bytes_ = 0;
    const double start = now();
    build(robust);
    best = std::min(best, now() - start);
  }
  build_seconds_ = best;
}

Yardstick::~Yardstick() {
  rtcReleaseScene(embree_);
  rtcReleaseDevice(device_);
}

void Yardstick::build(bool robust) {
  embree_ = rtcNewScene(device_);
  if (robust) rtcSetSceneFlags(embree_, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(embree_, RTC_BUILD_QUALITY_MEDIUM);
  if (!vertices_.empty()) {
    const RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const std::size_t count = vertices_.size() / 3;
    auto* v = static_cast<float*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, count));
    auto* t = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, count / 3));
    std::copy(vertices_.begin(), vertices_.end(), v);
    for (unsigned i = 0; i < count; ++i) t[i] = i;
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(embree_, mesh);
    rtcReleaseGeometry(mesh);
  }
  if (!others_.empty()) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(others_.size()));
    rtcSetGeometryUserData(geometry, &user_);
    rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcSetGeometryOccludedFunction(geometry, occlude);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(embree_, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(embree_);
}

void Yardstick::nearest(std::span<const NearestQuery> queries, double* distances) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Ray& ray = queries[i].ray;
    alignas(16) RTCRayHit q;
    q.ray.org_x = static_cast<float>(ray.origin.x), q.ray.org_y = static_cast<float>(ray.origin.y);
    q.ray.org_z = static_cast<float>(ray.origin.z);
    q.ray.dir_x = static_cast<float>(ray.direction.x), q.ray.dir_y = static_cast<float>(ray.direction.y);
    q.ray.dir_z = static_cast<float>(ray.direction.z);
    q.ray.tnear = static_cast<float>(queries[i].lo);
    q.ray.tfar = std::numeric_limits<float>::infinity();
    q.ray.mask = ~0u;
    q.ray.time = 0;
    q.ray.flags = 0;
    q.hit.geomID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(embree_, &context, &q);
    distances[i] = q.hit.geomID == RTC_INVALID_GEOMETRY_ID ? -1 : static_cast<double>(q.ray.tfar);
  }
}

void Yardstick::nearest16(std::span<const NearestQuery> queries, double* distances) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(64) RTCRayHit16 q;
  alignas(64) int valid[16];
  for (std::size_t first = 0; first < queries.size(); first += 16) {
    const std::size_t n = std::min<std::size_t>(16, queries.size() - first);
    for (std::size_t i = 0; i < 16; ++i) {
      const NearestQuery& query = queries[first + std::min(i, n - 1)];
      valid[i] = i < n ? -1 : 0;
      q.ray.org_x[i] = static_cast<float>(query.ray.origin.x),
      q.ray.org_y[i] = static_cast<float>(query.ray.origin.y);
      q.ray.org_z[i] = static_cast<float>(query.ray.origin.z);
      q.ray.dir_x[i] = static_cast<float>(query.ray.direction.x);
      q.ray.dir_y[i] = static_cast<float>(query.ray.direction.y);
      q.ray.dir_z[i] = static_cast<float>(query.ray.direction.z);
      q.ray.tnear[i] = static_cast<float>(query.lo);
      q.ray.tfar[i] = std::numeric_limits<float>::infinity();
      q.ray.mask[i] = ~0u;
      q.ray.time[i] = 0;
      q.ray.flags[i] = 0;
      q.hit.geomID[i] = q.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect16(valid, embree_, &context, &q);
    for (std::size_t i = 0; i < n; ++i) {
      distances[first + i] =
          q.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? -1 : static_cast<double>(q.ray.tfar[i]);
    }
  }
}

void Yardstick::occluded(std::span<const OcclusionQuery> queries, std::uint8_t* answers) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Ray& ray = queries[i].ray;
    alignas(16) RTCRay q;
    q.org_x = static_cast<float>(ray.origin.x), q.org_y = static_cast<float>(ray.origin.y);
    q.org_z = static_cast<float>(ray.origin.z);
    q.dir_x = static_cast<float>(ray.direction.x), q.dir_y = static_cast<float>(ray.direction.y);
    q.dir_z = static_cast<float>(ray.direction.z);
    q.tnear = static_cast<float>(std::max(queries[i].lo, 1e-4));
    q.tfar = static_cast<float>(queries[i].hi);
    q.mask = ~0u;
    q.time = 0;
    q.flags = 0;
    rtcOccluded1(embree_, &context, &q);
    answers[i] = q.tfar < 0;
  }
}

}  // namespace rayshade::bench
