// SPDX-License-Identifier: MIT
// Stationary points of the quartics that tori make along rays, and quartics in Bernstein form.
#pragma once

#include <array>

#include "rayshade/geometry/roots/bracket.h"

namespace rayshade::roots {

/// The real zeros of x^3 + p x + q in the open interval (a, b), ascending, one at a time: between them the
/// cubic keeps its sign, so that they split the interval into pieces on which its integral x^4/4 + p x^2/2 +
/// q x is monotone. Zeros where the cubic only touches may be left out; the integral is monotone there too.
/// Coefficients and interval should be of order one; a zero is accurate to the conditioning of the cubic.
class DepressedCubicZeros {
 public:
  DepressedCubicZeros(double p, double q, double a, double b);
  /// False where there are no more.
  bool next(double& zero);

 private:
  double value(double x) const { return (x * x + p_) * x + q_; }

  double p_, q_;
  std::array<double, 4> cuts_{};  ///< the cubic is monotone between neighbouring ones
  int count_ = 0;                 ///< of cuts
  int piece_ = 0;                 ///< the next to look at
  double value_;                  ///< at its left end
};

/// sum of b[i] binomial(4, i) x^i (1-x)^(4-i) on [0, 1].
struct BernsteinQuartic {
  std::array<double, 5> b;

  ValueAndSlope at(double x) const;
  /// Both halves; the middle value is the same number in both.
  void split(BernsteinQuartic& left, BernsteinQuartic& right) const;
  /// How often "positive" and "not positive" alternate along the coefficients: an upper bound of the number
  /// of sign changes on [0, 1], of the same parity.
  int variations() const;
};

/// Calls `found(x)` for the points of [0, 1] where the quartic changes between positive and not positive, in
/// ascending order, until it returns true. Two changes closer than 2^-50 are none. Their number is even
/// exactly if the states of b[0] and b[4] are the same. Returns whether `found` did.
template <class Found>
bool sign_changes(const BernsteinQuartic& quartic, Found&& found) {
  struct Piece {
    BernsteinQuartic quartic;
    double start, width;
  };
  constexpr int kDepth = 50;
  std::array<Piece, kDepth + 2> stack;  // NOLINT: filled as needed
  int top = 0;
  stack[0] = {quartic, 0, 1};
  while (top >= 0) {
    const Piece piece = stack[top--];
    const int variations = piece.quartic.variations();
    if (variations == 0) continue;
    const auto& b = piece.quartic.b;
    if (variations == 1) {
      const double x = bracketed_root([&](double at) { return piece.quartic.at(at); }, 0, 1, b[0] > 0,
                                      b[0] / (b[0] - b[4]), 0x1p-52);
      if (found(piece.start + x * piece.width)) return true;
      continue;
    }
    if (piece.width < 0x1p-50) {
      if ((b[0] > 0) != (b[4] > 0) && found(piece.start + 0.5 * piece.width)) return true;
      continue;
    }
    const double half = 0.5 * piece.width;
    BernsteinQuartic left, right;
    piece.quartic.split(left, right);
    stack[++top] = {right, piece.start + half, half};
    stack[++top] = {left, piece.start, half};
  }
  return false;
}

}  // namespace rayshade::roots
