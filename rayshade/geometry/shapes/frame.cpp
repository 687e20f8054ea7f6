// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/frame.h"

#include "rayshade/math/functions.h"

namespace rayshade {

AxisFrame::AxisFrame(const Vec3& axis) : AxisFrame() {
  const Vec3 w = normalize(axis);
  const double a = w.x, b = w.y, c = w.z;
  const double square = a * a + b * b;
  if (square == 0) {  // the poles; also tilts so small that they are lost in rounding
    if (c < 0) {
      y = {0, -1, 0};
      z = {0, 0, -1};
    }
    return;
  }
  // 1 + c cancels near the -z pole, where a and b still know the tilt.
  const double inverse = c < 0 ? (1 - c) / square : 1 / (1 + c);
  x = {1 - a * (a * inverse), -a * (b * inverse), -a};
  y = {x.y, 1 - b * (b * inverse), -b};
  z = w;
}

double turns_of_cosine(double c) {
  if (c > 1) return 0;
  if (c < -1) return 0.5;
  return fn::acos(c) / (2 * fn::kPi);
}

}  // namespace rayshade
