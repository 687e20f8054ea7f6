// SPDX-License-Identifier: MIT
// A thousand balls under a lamp, as text: nearest hits from an eye, and shadows.
#include <fas/fas.h>

#include <cmath>
#include <cstdio>
#include <vector>

class Balls final : public fas::Primitives {
 public:
  static constexpr std::uint32_t kSide = 10;
  static constexpr double kRadius = 0.35;

  std::uint32_t count() const override { return kSide * kSide * kSide; }
  fas::Point center(std::uint32_t i) const {
    return {i % kSide - 4.5, i / kSide % kSide - 4.5, i / (kSide * kSide) - 4.5};
  }
  void geometry(std::uint32_t i, fas::Geometry& out) const override {
    const fas::Point c = center(i);
    out.form = fas::Geometry::Form::kSpheres;
    out.spheres = 1;
    out.center[0] = c;
    out.radius[0] = kRadius;
    for (int k = 0; k < 3; ++k) out.box.lo[k] = c[k] - kRadius, out.box.hi[k] = c[k] + kRadius;
  }
  bool intersect(std::uint32_t i, const fas::Ray& ray, double limit, double& t) const override {
    const fas::Point c = center(i);
    double a = 0, b = 0, rest = -kRadius * kRadius;
    for (int k = 0; k < 3; ++k) {
      const double o = ray.origin[k] - c[k];
      a += ray.direction[k] * ray.direction[k], b += ray.direction[k] * o, rest += o * o;
    }
    const double root = std::sqrt(b * b - a * rest);  // not a number where the ray misses
    t = (-b - root) / a;
    if (t < ray.near) t = (-b + root) / a;
    return t >= ray.near && t <= limit;
  }
};

int main() {
  const Balls balls;
  fas::Structure structure(balls);
  const fas::Point eye{14, 17, 12}, lamp{2, 30, 10};
  const fas::RayClass from_eye = structure.rays_from(eye), toward_lamp = structure.rays_toward(lamp);
  fas::Tracer tracer(structure);
  for (int row = 0; row < 32; ++row) {
    std::vector<fas::Ray> rays(64);
    std::vector<fas::Hit> hits(rays.size());
    for (int x = 0; x < 64; ++x)
      rays[x] = {eye, {-14 + 0.18 * (32 - x), -17 - 0.18 * (32 - x), 0.4 * (16 - row) - 12}};
    tracer.nearest(from_eye, rays, hits);
    for (std::size_t x = 0; x < rays.size(); ++x) {
      if (hits[x].primitive == fas::Hit::kNone) {
        std::putchar(' ');
        continue;
      }
      fas::Ray shadow;  // from the surface to the lamp: t runs from 0 to 1
      for (int k = 0; k < 3; ++k) shadow.origin[k] = eye[k] + hits[x].t * rays[x].direction[k];
      for (int k = 0; k < 3; ++k) shadow.direction[k] = lamp[k] - shadow.origin[k];
      shadow.near = 1e-6, shadow.far = 1;
      std::putchar(tracer.occluded(toward_lamp, shadow) ? '.' : '#');
    }
    std::putchar('\n');
  }
}
