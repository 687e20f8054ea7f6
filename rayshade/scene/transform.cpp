// SPDX-License-Identifier: MIT
// Transform lists: composition at a moment, and bounds over an interval of times by interval arithmetic on
// the matrices.
#include "rayshade/scene/transform.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

/// Arguments that each kind uses.
std::size_t argument_count(StepKind kind) {
  switch (kind) {
    case StepKind::kScale:
    case StepKind::kTranslate:
      return 3;
    case StepKind::kRotate:
      return 4;
    case StepKind::kMatrix:
      return 12;
  }
  return 0;
}

/// The map of one animated step.
Affine step_at(const AnimatedStep& step, const Moment& moment) {
  double v[12];
  const std::size_t count = argument_count(step.kind);
  for (std::size_t i = 0; i < count; ++i) {
    v[i] = step.arguments[i].evaluate(moment);
    if (!std::isfinite(v[i])) {
      throw MotionError("a transform has no finite value", step.location, moment.time);
    }
  }
  switch (step.kind) {
    case StepKind::kScale:
      for (std::size_t i = 0; i < 3; ++i) {
        if (!is_scale_factor(v[i])) {
          throw MotionError(fmt::format("degenerate scale {:g} {:g} {:g}", v[0], v[1], v[2]), step.location,
                            moment.time);
        }
      }
      return scaling({v[0], v[1], v[2]});
    case StepKind::kTranslate:
      return translation({v[0], v[1], v[2]});
    case StepKind::kRotate:
      return rotation_degrees({v[0], v[1], v[2]}, v[3]);
    case StepKind::kMatrix:
      break;
  }
  const Affine out{{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}}, {v[9], v[10], v[11]}};
  if (!inverse(out)) {
    throw MotionError("singular matrix", step.location, moment.time);
  }
  return out;
}

struct IntervalVec {
  Interval c[3];
};

/// A map whose numbers are only known to lie in intervals. Its operations mirror those of Affine one by one,
/// so that they enclose the rounded results of those, too.
struct IntervalAffine {
  IntervalVec rows[3];
  IntervalVec translation;

  static IntervalAffine of(const Affine& a) {
    IntervalAffine out;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) out.rows[i].c[j] = Interval::point(a.rows[i][j]);
      out.translation.c[i] = Interval::point(a.translation[i]);
    }
    return out;
  }

  IntervalVec vector(const IntervalVec& v) const {
    IntervalVec out;
    for (int j = 0; j < 3; ++j) {
      out.c[j] = v.c[0] * rows[0].c[j] + v.c[1] * rows[1].c[j] + v.c[2] * rows[2].c[j];
    }
    return out;
  }
  IntervalVec point(const IntervalVec& p) const {
    IntervalVec out = vector(p);
    for (int j = 0; j < 3; ++j) out.c[j] = out.c[j] + translation.c[j];
    return out;
  }
};

IntervalAffine then(const IntervalAffine& first, const IntervalAffine& second) {
  IntervalAffine out;
  for (int i = 0; i < 3; ++i) out.rows[i] = second.vector(first.rows[i]);
  out.translation = second.point(first.translation);
  return out;
}

Interval square(const Interval& a) {
  const Interval product = a * a;
  return {std::max(product.lo, 0.0), product.hi};
}

/// `a` cut to [lo, hi], where it is known to lie but for rounding.
Interval within(const Interval& a, double lo, double hi) {
  const double slack = 1e-12;
  const Interval out{std::max(a.lo, lo - slack), std::min(a.hi, hi + slack)};
  return out.lo <= out.hi ? out : Interval{lo - slack, hi + slack};
}

IntervalAffine rotation_range(const IntervalVec& axis, const Interval& degrees) {
  const Interval sum = square(axis.c[0]) + square(axis.c[1]) + square(axis.c[2]);
  IntervalVec n;
  const Interval len = sqrt(sum);
  // Lengths near zero or overflow are scaled before they are divided by (normalize in vec.h) and a zero axis
  // turns nothing: there the components are only known to be at most 1.
  const bool known = len.lo > 1e-130 && len.hi < 1e130;
  for (int i = 0; i < 3; ++i) {
    const Interval quotient = known ? axis.c[i] / len : Interval{-1, 1};
    n.c[i] = within(quotient, -1, 1);
  }
  const Interval radians = degrees * Interval::point(fn::kPi / 180);
  const Interval c = cos(radians), s = sin(radians), one = Interval::point(1), k = one - c;
  const auto diagonal = [&](int i) { return within(square(n.c[i]) + (one - square(n.c[i])) * c, -1, 1); };
  const auto above = [&](int i, int j, int other) {
    return within(n.c[i] * n.c[j] * k + n.c[other] * s, -1, 1);
  };
  const auto below = [&](int i, int j, int other) {
    return within(n.c[i] * n.c[j] * k - n.c[other] * s, -1, 1);
  };
  IntervalAffine out;
  out.rows[0] = {{diagonal(0), above(0, 1, 2), below(0, 2, 1)}};
  out.rows[1] = {{below(0, 1, 2), diagonal(1), above(1, 2, 0)}};
  out.rows[2] = {{above(0, 2, 1), below(1, 2, 0), diagonal(2)}};
  for (Interval& t : out.translation.c) t = Interval::point(0);
  return out;
}

IntervalAffine step_range(const AnimatedStep& step, const Interval& time, double frame) {
  Interval v[12];
  const std::size_t count = argument_count(step.kind);
  for (std::size_t i = 0; i < count; ++i) v[i] = step.arguments[i].evaluate(time, frame);
  IntervalAffine out = IntervalAffine::of({});
  switch (step.kind) {
    case StepKind::kScale:
      for (int i = 0; i < 3; ++i) out.rows[i].c[i] = v[i];
      break;
    case StepKind::kTranslate:
      for (int i = 0; i < 3; ++i) out.translation.c[i] = v[i];
      break;
    case StepKind::kRotate:
      return rotation_range({{v[0], v[1], v[2]}}, v[3]);
    case StepKind::kMatrix:
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) out.rows[i].c[j] = v[3 * i + j];
        out.translation.c[i] = v[9 + i];
      }
      break;
  }
  return out;
}

}  // namespace

MotionError::MotionError(const std::string& what, Location where, double when)
    : std::runtime_error(fmt::format("{} at time {:g}", what, when)), location(where), time(when) {}

void TransformList::append(const Affine& map) {
  if (!elements_.empty() && !elements_.back().animated) {
    elements_.back().constant = then(elements_.back().constant, map);
  } else {
    elements_.push_back({map, std::nullopt});
  }
}

void TransformList::append(AnimatedStep step) {
  elements_.push_back({{}, std::move(step)});
  animated_ = true;
}

void TransformList::append(const TransformList& later) {
  const std::vector<Element> others = later.elements_;  // a copy: `later` may be this list
  for (const Element& element : others) {
    if (element.animated) {
      append(*element.animated);
    } else {
      append(element.constant);
    }
  }
}

Affine TransformList::at(const Moment& moment) const {
  Affine out;
  bool first = true;
  for (const Element& element : elements_) {
    const Affine map = element.animated ? step_at(*element.animated, moment) : element.constant;
    out = first ? map : then(out, map);
    first = false;
  }
  return out;
}

namespace {

/// A box that holds `box` under every map of the range. Corners need not be tried: each output coordinate is
/// a sum of products, one per input coordinate, and each product is bounded over its whole interval.
Bounds3 moved(const Bounds3& box, const IntervalAffine& map) {
  const IntervalVec corners{{{box.lo.x, box.hi.x}, {box.lo.y, box.hi.y}, {box.lo.z, box.hi.z}}};
  const IntervalVec range = map.point(corners);
  Bounds3 out;
  double size = 0;
  for (int j = 0; j < 3; ++j) {
    out.lo[j] = range.c[j].lo;
    out.hi[j] = range.c[j].hi;
    const auto magnitude = [](const Interval& a) { return std::max(std::fabs(a.lo), std::fabs(a.hi)); };
    double sum = magnitude(map.translation.c[j]);
    for (int i = 0; i < 3; ++i) sum += magnitude(corners.c[i]) * magnitude(map.rows[i].c[j]);
    size = std::max(size, sum);
  }
  if (!std::isfinite(size)) return Bounds3::everything();
  // Rounding of a point that a caller takes through the map in another order of operations.
  return grown(out, 16 * std::numeric_limits<double>::epsilon() * size);
}

bool sticks_out(const Bounds3& piece, const Bounds3& inner, double share) {
  const Vec3 margin = inner.extent() * share;
  for (int j = 0; j < 3; ++j) {
    if (piece.lo[j] < inner.lo[j] - margin[j] || piece.hi[j] > inner.hi[j] + margin[j]) return true;
  }
  return false;
}

}  // namespace

Bounds3 TransformList::motion_bounds(const Bounds3& box, const Interval& time, double frame) const {
  if (box.empty() || elements_.empty()) return box;
  if (box.unbounded()) return Bounds3::everything();
  if (!animated_) return transformed(box, at({time.lo, frame}));

  const auto range_over = [&](const Interval& when) {
    IntervalAffine out = IntervalAffine::of({});
    bool first = true;
    for (const Element& element : elements_) {
      const IntervalAffine map = element.animated ? step_range(*element.animated, when, frame)
                                                  : IntervalAffine::of(element.constant);
      out = first ? map : then(out, map);
      first = false;
    }
    return moved(box, out);
  };

  // Pieces of the interval that reach out of the box of the positions known so far are halved: the longest
  // first, so that a rotation gets its extremes cut finely and the rest coarsely. What a piece may stick out
  // by, and the number of pieces, only decide how tight the result is.
  constexpr double kSlack = 0.01;
  constexpr int kLevels = 10;
  constexpr int kMaxPieces = 400;
  struct Piece {
    Interval when;
    Bounds3 bounds;
  };
  Bounds3 inner = join(range_over(Interval::point(time.lo)), range_over(Interval::point(time.hi)));
  std::vector<Piece> pieces{{time, range_over(time)}};
  Bounds3 done;
  int evaluated = 1;
  for (int level = 0; level < kLevels && !pieces.empty(); ++level) {
    std::vector<Piece> halves;
    for (const Piece& piece : pieces) {
      const double middle = piece.when.lo + (piece.when.hi - piece.when.lo) / 2;
      const bool divisible = middle > piece.when.lo && middle < piece.when.hi && evaluated < kMaxPieces;
      if (!divisible || !sticks_out(piece.bounds, inner, kSlack)) {
        done.add(piece.bounds);
        continue;
      }
      evaluated += 2;
      inner.add(range_over(Interval::point(middle)));
      for (const Interval& half : {Interval{piece.when.lo, middle}, Interval{middle, piece.when.hi}}) {
        const Bounds3 bounds = range_over(half);
        halves.push_back({half, intersection(bounds, piece.bounds)});
      }
    }
    pieces = std::move(halves);
  }
  for (const Piece& piece : pieces) done.add(piece.bounds);
  return done.unbounded() ? Bounds3::everything() : done;
}

}  // namespace rayshade
