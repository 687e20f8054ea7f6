// SPDX-License-Identifier: MIT
// Rays through many points of the screen at once. What every lane computes, it would compute alone: the fused
// sums of fused::unit_of_sum(), where the instruction set has them; elsewhere the points go one by one.
#include "fas/compiled_targets.h"
#include "rayshade/sampling/camera.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE \
  "rayshade/sampling/camera_rays.cpp"  // NOLINT: Highway includes this file once per target
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "fas/dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace rayshade::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void one_by_one(const Vec3& corner, const Vec3& step_x, const Vec3& step_y, ScreenPoints& points,
                std::size_t first, std::size_t count) {
  for (std::size_t i = first; i < first + count; ++i) {
    Vec3 direction;
    fused::unit_of_sum(corner, points.u[i], step_x, points.v[i], step_y, direction);
    for (int axis = 0; axis < 3; ++axis) points.to[axis][i] = direction[axis];
  }
}

#if HWY_NATIVE_FMA
HWY_ATTR void aim(const Vec3& corner, const Vec3& step_x, const Vec3& step_y, ScreenPoints& points) {
  const hn::CappedTag<double, 8> d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < points.count; i += lanes) {
    const auto u = hn::Load(d, points.u + i), v = hn::Load(d, points.v + i);
    const auto sum = [&](int axis) HWY_ATTR {
      return hn::MulAdd(v, hn::Set(d, step_y[axis]),
                        hn::MulAdd(u, hn::Set(d, step_x[axis]), hn::Set(d, corner[axis])));
    };
    const auto x = sum(0), y = sum(1), z = sum(2);
    const auto square = hn::MulAdd(z, z, hn::MulAdd(y, y, hn::Mul(x, x)));
    const auto length = hn::Sqrt(square);
    hn::Store(hn::Div(x, length), d, points.to[0] + i);
    hn::Store(hn::Div(y, length), d, points.to[1] + i);
    hn::Store(hn::Div(z, length), d, points.to[2] + i);
    const auto usual = hn::And(hn::Gt(square, hn::Set(d, 1e-280)), hn::Lt(square, hn::Set(d, 1e280)));
    if (!hn::AllTrue(d, usual))
      one_by_one(corner, step_x, step_y, points, i, std::min(lanes, points.count - i));
  }
}
#else
void aim(const Vec3& corner, const Vec3& step_x, const Vec3& step_y, ScreenPoints& points) {
  one_by_one(corner, step_x, step_y, points, 0, points.count);
}
#endif

}  // namespace rayshade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayshade {

namespace {
constexpr auto kAim = FAS_VERSIONS(aim);
}

void Camera::aim(ScreenPoints& points) const { kAim.best()(corner_, step_x_, step_y_, points); }

}  // namespace rayshade
#endif
