// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/frame.h"

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

double turns_of_cosine(double c) {
  if (c > 1) return 0;
  if (c < -1) return 0.5;
  return fn::acos(c) / (2 * fn::kPi);
}

}  // namespace rayshade
