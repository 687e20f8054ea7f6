// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/blob.h"

#include <array>
#include <limits>

#include "rayshade/geometry/roots/quartic.h"

namespace rayshade {
namespace {

constexpr double kUlp = std::numeric_limits<double>::epsilon();
constexpr std::uint32_t kClusterSize = 8;
/// From this many balls on, searching each one's neighbours for tight bounds costs too much.
constexpr std::size_t kManyBalls = 2000;

}  // namespace

/// A ray as x -> origin + x direction, with a direction of unit length and an origin near the blob;
/// t = shift + x scale.
struct Blob::LocalRay {
  Vec3 origin, direction;
  double shift, scale;

  double t(double x) const { return shift + x * scale; }
};

/// A list without heap memory while it is short.
class Blob::Spans {
 public:
  void add(const Span& span) {
    if (count_ < inline_.size()) {
      inline_[count_++] = span;
      return;
    }
    if (heap_.empty()) heap_.assign(inline_.begin(), inline_.end());
    heap_.push_back(span);
    ++count_;
  }
  Span* begin() { return heap_.empty() ? inline_.data() : heap_.data(); }
  Span* end() { return begin() + count_; }
  bool empty() const { return count_ == 0; }

 private:
  std::array<Span, 32> inline_;  // NOLINT: filled as needed
  std::size_t count_ = 0;
  std::vector<Span> heap_;
};

Blob::Blob(const shape::Blob& blob) : threshold_(blob.threshold) {
  balls_.reserve(blob.balls.size());
  for (const shape::Metaball& ball : blob.balls) {
    balls_.push_back({ball.center, ball.radius, 1 / (ball.radius * ball.radius), ball.strength});
  }
  make_bounds();
  make_clusters(0, static_cast<std::uint32_t>(balls_.size()));
}

void Blob::make_bounds() {
  Bounds3 influence;
  for (const Ball& ball : balls_) influence.add(grown({ball.center, ball.center}, ball.radius));
  middle_ = influence.empty() ? Vec3{} : influence.center();
  // Where m balls overlap and their sum is T, one of them contributes at least T / m. A ball overlaps no more
  // than those whose spheres of influence touch its own.
  for (const Ball& ball : balls_) {
    double overlapping = static_cast<double>(balls_.size());
    if (balls_.size() < kManyBalls) {
      overlapping = 0;
      for (const Ball& other : balls_) {
        const double reach = ball.radius + other.radius;
        overlapping += length_squared(ball.center - other.center) <= reach * reach * (1 + 1e-12);
      }
    }
    const double share = std::max(0.0, threshold_) / (overlapping * ball.strength);
    if (share > 1 + 1e-12) continue;
    const double reach = ball.radius * std::sqrt(std::max(0.0, 1 - std::sqrt(share)) + 1e-12);
    bounds_.add(grown({ball.center, ball.center}, std::min(reach, ball.radius)));
  }
  if (bounds_.empty()) bounds_ = influence;  // nothing to be seen; but a box has to be somewhere
  bounds_ = grown(bounds_, 1e-12 * (influence.largest_extent() + max_abs(middle_)));
}

void Blob::make_clusters(std::uint32_t first, std::uint32_t count) {
  const auto begin = balls_.begin() + first, end = begin + count;
  Bounds3 centers, influence;
  for (auto ball = begin; ball != end; ++ball) {
    centers.add(ball->center);
    influence.add(grown({ball->center, ball->center}, ball->radius));
  }
  if (count > kClusterSize) {
    const int axis = dominant_axis(centers.extent());
    const std::uint32_t half = count / 2;
    std::stable_sort(begin, end,
                     [axis](const Ball& a, const Ball& b) { return a.center[axis] < b.center[axis]; });
    make_clusters(first, half);
    make_clusters(first + half, count - half);
    return;
  }
  if (count == 0) return;
  Cluster cluster{influence.center(), 0, first, count};
  double radius = 0;
  for (auto ball = begin; ball != end; ++ball) {
    radius = std::max(radius, length(ball->center - cluster.center) + ball->radius);
  }
  // Beyond all rounding of the tests of the balls, which work at distances up to the size of the blob.
  radius = radius * (1 + 1e-9) + 1e-12 * bounds_.largest_extent();
  cluster.radius_square = radius * radius;
  clusters_.push_back(cluster);
}

bool Blob::collect(const LocalRay& ray, Spans& spans) const {
  double peaks = 0;
  for (const Cluster& cluster : clusters_) {
    if (clusters_.size() > 1) {
      const Vec3 to = cluster.center - ray.origin;
      if (length_squared(to - dot(to, ray.direction) * ray.direction) > cluster.radius_square) continue;
    }
    const Ball* ball = balls_.data() + cluster.first;
    for (const Ball* end = ball + cluster.count; ball != end; ++ball) {
      const Vec3 to = ball->center - ray.origin;
      const double along = dot(to, ray.direction);
      const double miss_square = length_squared(to - along * ray.direction);
      const double half_square = ball->radius * ball->radius - miss_square;
      if (!(half_square > 0)) continue;
      const double peak = half_square * ball->inverse_square;
      peaks += ball->strength * peak * peak;
      const double half = std::sqrt(half_square);
      spans.add({along - half, along + half, ball});
    }
  }
  return peaks > threshold_ * (1 - 1e-12);
}

bool Blob::intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
  if (threshold_ < 0) return false;  // the field is above it everywhere
  const Vec3& d = ray.direction;
  const double dd = dot(d, d);
  const double per_length = 1 / std::sqrt(dd);
  const double shift = -dot(ray.origin - middle_, d) / dd;
  const LocalRay local{ray.at(shift), d * per_length, shift, per_length};
  Spans spans;
  if (!collect(local, spans) || spans.empty()) return false;
  double t = 0;
  if (!first_crossing(local, spans, lo, hi, t) || t > hi) return false;
  hit = {t, 0, 0, 0};
  return true;
}

bool Blob::first_crossing(const LocalRay& ray, Spans& spans, double lo, double hi, double& t) const {
  std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) {
    return a.enter < b.enter || (a.enter == b.enter && a.ball < b.ball);
  });
  // Spans that hold the current interval are kept, in order, at the front; those to come start at `next`.
  Span* const active = spans.begin();
  std::ptrdiff_t active_count = 0;
  Span* next = active;
  double x = next->enter;
  bool inside = false;  // at x, seen from the left; not kept up to date before lo, where no crossing counts
  const auto accept = [&](double at) {
    t = ray.t(at);
    return t > lo;
  };
  while (true) {
    if (active_count == 0) {
      if (inside && accept(x)) return true;
      inside = false;
      if (next == spans.end()) return false;
      x = next->enter;
    }
    double end = std::numeric_limits<double>::infinity();
    for (; next != spans.end() && next->enter <= x; ++next) active[active_count++] = *next;
    if (next != spans.end()) end = next->enter;
    for (std::ptrdiff_t i = 0; i < active_count; ++i) end = std::min(end, active[i].exit);
    if (ray.t(x) > hi) return false;
    if (end > x && ray.t(end) > lo) {
      // A ball's u = 1 - |p - c|^2 / r^2 has the Bernstein coefficients u(x), its blossom u(x, end), u(end);
      // the product rule gives those of the square.
      const Vec3 p0 = ray.origin + x * ray.direction, p1 = ray.origin + end * ray.direction;
      roots::BernsteinQuartic quartic{{-threshold_, -threshold_, -threshold_, -threshold_, -threshold_}};
      for (std::ptrdiff_t i = 0; i < active_count; ++i) {
        const Ball& ball = *active[i].ball;
        const Vec3 q0 = p0 - ball.center, q1 = p1 - ball.center;
        const double u0 = 1 - dot(q0, q0) * ball.inverse_square, u1 = 1 - dot(q0, q1) * ball.inverse_square,
                     u2 = 1 - dot(q1, q1) * ball.inverse_square;
        quartic.b[0] += ball.strength * (u0 * u0);
        quartic.b[1] += ball.strength * (u0 * u1);
        quartic.b[2] += ball.strength * ((u0 * u2 + 2 * (u1 * u1)) / 3);
        quartic.b[3] += ball.strength * (u1 * u2);
        quartic.b[4] += ball.strength * (u2 * u2);
      }
      // The state may change at the boundary itself: where the threshold is zero, or in the last place of a
      // root that lies there.
      if (inside != (quartic.b[0] > 0) && accept(x)) return true;
      const double width = end - x;
      if (roots::sign_changes(quartic, [&](double at) { return accept(x + at * width); })) return true;
      inside = quartic.b[4] > 0;
    }
    x = end;
    std::ptrdiff_t kept = 0;
    for (std::ptrdiff_t i = 0; i < active_count; ++i) {
      if (active[i].exit > x) active[kept++] = active[i];
    }
    active_count = kept;
  }
}

Blob::Field Blob::field(const Vec3& p) const {
  Field out{-threshold_, {}, 0, 0};
  double strengths = 0;
  for (const Ball& ball : balls_) {
    const Vec3 q = p - ball.center;
    const double u = 1 - dot(q, q) * ball.inverse_square;
    if (u < 0) continue;
    out.value += ball.strength * u * u;
    out.outward += (4 * ball.strength * ball.inverse_square * u) * q;
    out.curvature += 8 * ball.strength * ball.inverse_square;
    strengths += ball.strength;
  }
  // u is below 1 and rounds by at most 4 units (p and the centres are exact: one for each difference, twice;
  // one for each product and sum, one for the subtraction, all of numbers up to 1), so u^2 by 8 and more for
  // its product and sum; every sum of k terms adds k / 2 of the total.
  out.rounding = kUlp * (10 + 0.5 * static_cast<double>(balls_.size())) * (strengths + std::fabs(threshold_));
  return out;
}

SurfacePoint Blob::surface_point(const Ray& ray, const ShapeHit& hit) const {
  SurfacePoint out;
  out.point = ray.at(hit.t);
  Field f = field(out.point);
  for (int i = 0; i < 4; ++i) {
    const double slope_square = length_squared(f.outward);
    // Newton's step toward the surface, where its convergence is certain.
    if (std::fabs(f.value) <= f.rounding || !(2 * std::fabs(f.value) * f.curvature < slope_square)) break;
    const Vec3 moved = out.point + f.outward * (f.value / slope_square);
    const Field g = field(moved);
    if (!(std::fabs(g.value) < std::fabs(f.value))) break;
    out.point = moved;
    f = g;
  }
  Vec3 normal = f.outward;
  if (max_abs(normal) == 0) {
    // Threshold zero, at the border of the influence: away from the ball whose border it is.
    double nearest = std::numeric_limits<double>::infinity();
    for (const Ball& ball : balls_) {
      const Vec3 q = out.point - ball.center;
      const double off = std::fabs(1 - dot(q, q) * ball.inverse_square);
      if (off < nearest) nearest = off, normal = q;
    }
  }
  if (max_abs(normal) == 0) normal = -ray.direction;
  out.normal = out.geometric_normal = normalize(normal);
  // By the mean value theorem the distance is |F - T| over the slope, which is at least half of that at the
  // point as long as 2 |F - T| times the second derivative is below the square of the slope; where the field
  // is flatter than this (a critical point at the threshold) the distance goes with the square root.
  const double residue = std::fabs(f.value) + f.rounding;
  const double slope = std::max(length(f.outward), std::sqrt(2 * residue * f.curvature));
  out.error = slope > 0 ? 2 * residue / slope : kUlp * (max_abs(out.point) + bounds_.largest_extent());
  return out;
}

bool Blob::entering(const Ray& ray, double /*lo*/, const ShapeHit& hit) const {
  return dot(surface_point(ray, hit).geometric_normal, ray.direction) < 0;
}

TextureCoordinates Blob::texture_coordinates(const Vec3&, const Vec3&, const ShapeHit&) const { return {}; }

}  // namespace rayshade
