// SPDX-License-Identifier: MIT
#include "rayshade/shading/light_aims.h"

#include "fas/compiled_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE \
  "rayshade/shading/light_aims.cpp"  // NOLINT: Highway includes this file once per target
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fas/dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace rayshade::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

/// As dot() of vec.h.
HWY_ATTR inline V dot3(V ax, V ay, V az, V bx, V by, V bz) { return ax * bx + ay * by + az * bz; }

HWY_ATTR void aim(const ShadingLight& light, LightAims& aims) {
  const D d;
  const bool directional = light.kind == LightKind::kDirectional, area = light.kind == LightKind::kArea;
  const V px = hn::Set(d, light.position.x), py = hn::Set(d, light.position.y),
          pz = hn::Set(d, light.position.z);
  for (std::size_t i = 0; i < aims.count; i += hn::Lanes(d)) {
    V x = px, y = py, z = pz, distance = hn::Set(d, kFar);
    if (!directional) {
      if (area) {
        x = hn::Load(d, aims.place[0] + i);
        y = hn::Load(d, aims.place[1] + i);
        z = hn::Load(d, aims.place[2] + i);
      }
      x = x - hn::Load(d, aims.point[0] + i);
      y = y - hn::Load(d, aims.point[1] + i);
      z = z - hn::Load(d, aims.point[2] + i);
      distance = hn::Sqrt(dot3(x, y, z, x, y, z));
      x = x / distance;
      y = y / distance;
      z = z / distance;
    }
    hn::Store(x, d, aims.direction[0] + i);
    hn::Store(y, d, aims.direction[1] + i);
    hn::Store(z, d, aims.direction[2] + i);
    hn::Store(distance, d, aims.distance + i);
    const V cosine = dot3(x, y, z, hn::Load(d, aims.normal[0] + i), hn::Load(d, aims.normal[1] + i),
                          hn::Load(d, aims.normal[2] + i));
    const V highlight = dot3(hn::Load(d, aims.mirror[0] + i), hn::Load(d, aims.mirror[1] + i),
                             hn::Load(d, aims.mirror[2] + i), x, y, z);
    hn::Store(cosine, d, aims.cosine + i);
    hn::Store(highlight, d, aims.highlight + i);
  }
}

}  // namespace rayshade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayshade {

namespace {
constexpr auto kAim = FAS_VERSIONS(aim);
}

void aim_at(const ShadingLight& light, LightAims& aims) { kAim.best()(light, aims); }

}  // namespace rayshade
#endif
