// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/frame.h"

#include <algorithm>
#include <cmath>

#include "rayshade/math/functions.h"

namespace rayshade {

AxisFrame axis_frame(const Vec3& axis) {
  const Vec3 w = normalize(axis);
  const double a = w.x, b = w.y, c = w.z;
  const double square = a * a + b * b;
  if (square == 0) {  // the poles, and tilts that vanish in the squares
    if (c < 0) return {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  }
  // 1 + c cancels near the -z pole, where a and b still know the tilt.
  const double inverse = c < 0 ? (1 - c) / square : 1 / (1 + c);
  const double xy = -a * (b * inverse);
  return {{{1 - a * (a * inverse), xy, -a}, {xy, 1 - b * (b * inverse), -b}, w}};
}

double turns(double c, double s, bool mirrored) {
  constexpr double kOnSurface = 1e-6;  // thin tubes far from the origin are rounded that much
  const double angle = std::fabs(c * c + s * s - 1) < kOnSurface ? fn::atan2(std::fabs(s), c)
                                                                 : fn::acos(std::clamp(c, -1.0, 1.0));
  const double out = angle / (2 * fn::kPi);
  return mirrored ? 1 - out : out;
}

}  // namespace rayshade
