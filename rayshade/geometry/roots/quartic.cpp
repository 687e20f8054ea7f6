// SPDX-License-Identifier: MIT
#include "rayshade/geometry/roots/quartic.h"

namespace rayshade::roots {

DepressedCubicZeros::DepressedCubicZeros(double p, double q, double a, double b) : p_(p), q_(q) {
  cuts_[count_++] = a;
  if (p < 0) {
    const double turn = std::sqrt(-p / 3);
    if (-turn > a && -turn < b) cuts_[count_++] = -turn;
    if (turn > a && turn < b) cuts_[count_++] = turn;
  }
  cuts_[count_++] = b;
  value_ = value(a);
}

bool DepressedCubicZeros::next(double& zero) {
  while (piece_ + 1 < count_) {
    const double left = cuts_[piece_], right = cuts_[piece_ + 1];
    const double left_value = value_;
    value_ = value(right);
    ++piece_;
    const bool positive = left_value > 0;
    if (positive == (value_ > 0)) continue;
    // First guesses: the middle zero is near -q / p, the outer ones near +-sqrt(-p) + q / (2 p).
    double guess = -q_ / p_;
    if (p_ < 0 && !positive) guess = (left > 0 ? std::sqrt(-p_) : -std::sqrt(-p_)) + q_ / (2 * p_);
    // The integral changes with the square of the error of its stationary points: half the digits would do.
    zero = bracketed_root(
        [this](double x) {
          return ValueAndSlope{value(x), 3 * x * x + p_};
        },
        left, right, positive, guess, 1e-14);
    return true;
  }
  return false;
}

ValueAndSlope BernsteinQuartic::at(double x) const {
  // The last step of de Casteljau's scheme gives value and slope together.
  const double y = 1 - x;
  const double xx = x * x, yy = y * y, x3 = 3 * x, y3 = 3 * y;
  const double left = (b[0] * y + b[1] * x3) * yy + (b[2] * y3 + b[3] * x) * xx;
  const double right = (b[1] * y + b[2] * x3) * yy + (b[3] * y3 + b[4] * x) * xx;
  return {left * y + right * x, 4 * (right - left)};
}

void BernsteinQuartic::split(BernsteinQuartic& left, BernsteinQuartic& right) const {
  const double m01 = 0.5 * (b[0] + b[1]), m12 = 0.5 * (b[1] + b[2]), m23 = 0.5 * (b[2] + b[3]),
               m34 = 0.5 * (b[3] + b[4]);
  const double n0 = 0.5 * (m01 + m12), n1 = 0.5 * (m12 + m23), n2 = 0.5 * (m23 + m34);
  const double o0 = 0.5 * (n0 + n1), o1 = 0.5 * (n1 + n2);
  const double middle = 0.5 * (o0 + o1);
  left.b = {b[0], m01, n0, o0, middle};
  right.b = {middle, o1, n2, m34, b[4]};
}

int BernsteinQuartic::variations() const {
  int out = 0;
  for (int i = 0; i < 4; ++i) out += (b[i] > 0) != (b[i + 1] > 0);
  return out;
}

}  // namespace rayshade::roots
