// SPDX-License-Identifier: MIT
// Transform lists as written after an object or a texture (language.md 3.8, objects.md 1.4 to 1.7).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "rayshade/math/affine.h"
#include "rayshade/math/bounds.h"
#include "rayshade/scene/expression.h"
#include "rayshade/scene/location.h"

namespace rayshade {

enum class StepKind : std::uint8_t { kScale, kTranslate, kRotate, kMatrix };

/// Whether `scale` takes a factor: not where it is smaller than kEpsilon or not finite (objects.md 1.7).
inline bool is_scale_factor(double factor) { return std::fabs(factor) >= kEpsilon && std::isfinite(factor); }

/// One written transform with at least one time-varying argument. Arguments in written order: kScale and
/// kTranslate use 3, kRotate 4 (axis, degrees), kMatrix 12 (rows, then translation).
struct AnimatedStep {
  StepKind kind = StepKind::kScale;
  std::array<Expression, 12> arguments;
  Location location;
};

/// A degenerate value reached while moving (scale 0, singular matrix); rendering stops with an error that
/// names the time and the place.
struct MotionError : std::runtime_error {
  /// The time is added to `what`.
  MotionError(const std::string& what, Location where, double when);
  Location location;
  double time;
};

/// A list of transforms, applied in the order written. Runs of constant ones are folded into one map; the
/// inverse is always computed from the folded map, so that the canonical dump of a scene renders to the same
/// bytes.
class TransformList {
 public:
  struct Element {
    Affine constant;  ///< used when `animated` is empty
    std::optional<AnimatedStep> animated;
  };

  bool empty() const { return elements_.empty(); }
  bool animated() const { return animated_; }
  /// Appends a constant map, folding it into the last element if that is constant too.
  void append(const Affine& map);
  void append(AnimatedStep step);
  /// Appends all of another list after this one.
  void append(const TransformList& later);
  const std::vector<Element>& elements() const { return elements_; }

  /// The composed map at a moment. Throws MotionError where an animated step is degenerate.
  Affine at(const Moment& moment) const;
  /// A box that contains `box` moved by this list at every time of the interval (conservative, by interval
  /// arithmetic over pieces of the interval).
  Bounds3 motion_bounds(const Bounds3& box, const Interval& time, double frame) const;

 private:
  std::vector<Element> elements_;
  bool animated_ = false;
};

}  // namespace rayshade
