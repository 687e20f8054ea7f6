// SPDX-License-Identifier: MIT
// Trials of single rays: whole queries - transform chains, shapes, normals in the world, surface coordinates,
// the start of rays that leave a hit - against the equations in 113 bits, on rays that are ordinary and rays
// that hurt.
//
// Distances and normals are measured in units of what one rounding of the numbers at hand must cost:
// kRoundoff times the largest size that takes part (of the ray, the chain of transforms and the shape, in the
// space of the shape), over the cosine under which the ray meets the surface; near tangency this cosine is
// that of a ray displaced by as much. Normals and starts go outward map by map, and every map costs one. A
// hit or miss counts as decided where no change of the ray by a few hundred units could alter it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "rayshade/geometry/resolve.h"
#include "rayshade/geometry/shapes/rounding.h"
#include "tests/stress/chain.h"
#include "tests/stress/markdown.h"

namespace rayshade::stress {

using test::Dice;
using test::SceneBuilder;

constexpr double kDecided = 300;

enum Family {
  kNear,
  kFarAway,
  kInside,
  kOnSurface,
  kGrazing,
  kThroughMarks,
  kAxisParallel,
  kExtreme,
  kFamilies
};

/// `reach`: how near the line must come to touching for that to matter.
template <class Reference>
quad::Crossings all_crossings(const Reference& reference, const quad::Line& line, const Q& reach) {
  if constexpr (requires { reference.crossings(line, reach); }) {
    return reference.crossings(line, reach);
  } else {
    return reference.crossings(line);
  }
}

struct Subject {
  Vec3 center;
  double size = 1, conditioning = 1;  ///< as in shapes_accuracy_test.cpp
  std::vector<Vec3> marks;            ///< vertices and points of edges
};

struct Tally {
  std::uint64_t rays = 0, hits = 0, undecided = 0, false_hits = 0, missed = 0, wrong_side = 0;
  std::vector<float> distance, normal, uv, start;
};

template <class Reference>
class Trial {
 public:
  Trial(SceneBuilder& b, NodeId shape, const Reference& reference, Subject subject, int depth, Dice& dice)
      : reference_(reference), subject_(std::move(subject)), dice_(dice) {
    for (int i = 0; i < depth; ++i) {
      const Affine map = odd_map(dice, subject_.size);
      chain_.append(map);
      shape = b.list({b.moved(shape, map)});
    }
    b.show(shape);
    scene_ = b.compile();
    world_ = make_brute_force(*scene_);
    inverse_growth_ = chain_.inverse_growth();
    condition_ = (1 + depth) * std::max(1.0, chain_.growth() * inverse_growth_ / 9);
  }

  void shoot(Tally& tally) {
    double lo = 0;
    const Ray ray = make_ray(static_cast<Family>(dice_.below(kFamilies)), lo);
    const quad::Line line = chain_.inner(ray);
    const double speed = static_cast<double>(quad::length(line.d));
    ++tally.rays;
    const double outer = length(ray.origin) + static_cast<double>(quad::length(chain_.shift)),
                 base = static_cast<double>(quad::length(line.o - V(subject_.center))) + subject_.size +
                        length(subject_.center);
    const auto sizes = [&](const Q& t) {
      const double far = std::fabs(static_cast<double>(t));
      return subject_.conditioning *
             (base + far * speed + inverse_growth_ * (outer + far * length(ray.direction)));
    };
    const quad::Crossings crossings = all_crossings(reference_, line, kDecided * kRoundoff * sizes(0));
    const auto cost = [&](const quad::Crossing& c) { return sizes(c.t) + static_cast<double>(c.softness); };
    const auto effective_cosine = [&](const quad::Crossing& c) {
      const double floor =
          c.curvature > 0 ? std::sqrt(kRoundoff * cost(c) / static_cast<double>(c.curvature)) : 0;
      return std::clamp(static_cast<double>(c.cosine), std::min(floor, 1.0), 1.0);
    };
    const quad::Crossing* expected = nullptr;
    bool decided = crossings.from_tangency > kDecided * kRoundoff * sizes(0);
    for (const quad::Crossing& c : crossings.all) {
      const double reach = kDecided * kRoundoff * cost(c) / effective_cosine(c);
      if (abs(c.inside) < reach || abs(c.t - lo) * speed < reach) decided = false;
      if (!expected && c.inside >= 0 && c.t >= lo) expected = &c;
    }
    const NearestAnswer answer =
        test::nearest(*world_, ray, scratch_, lo, std::numeric_limits<double>::max());
    if (!decided) {
      ++tally.undecided;
      return;
    }
    const bool wrong = answer.found != (expected != nullptr);
    const auto describe = [&] {
      return format("origin %a %a %a direction %a %a %a lo %a, found %.17g instead of %.17g", ray.origin.x,
                    ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z, lo,
                    answer.found ? answer.hit.t() : -1, expected ? static_cast<double>(expected->t) : -1);
    };
    if (wrong && reported_++ < 3) {
      ADD_FAILURE() << (answer.found ? "false hit: " : "missed hit: ") << describe();
    }
    tally.false_hits += wrong && answer.found;
    tally.missed += wrong && !answer.found;
    if (!answer.found || wrong) return;
    ++tally.hits;
    const double s = cost(*expected), cosine = effective_cosine(*expected);
    const double off =
        static_cast<double>(abs(Q(answer.hit.t()) - expected->t)) * speed * cosine / (kRoundoff * s);
    tally.distance.push_back(static_cast<float>(off));
    if (off > kDecided && reported_++ < 3) ADD_FAILURE() << "another hit: " << describe();
    if (expected->inside < 1e-4 * subject_.size) return;  // normals of boxes change near their edges
    const WorldHit at = resolve_world(*scene_, answer.hit, ray, scratch_);
    const V p = line.at(expected->t), exact = chain_.outer_normal(reference_.normal(p));
    const double turn = std::min(static_cast<double>(quad::length(V(at.normal) - exact)),
                                 static_cast<double>(quad::length(V(at.normal) + exact)));
    const double bend = expected->turning > 0 ? s / (static_cast<double>(expected->turning) * cosine) : 0;
    tally.normal.push_back(
        static_cast<float>(turn / (kRoundoff * condition_ * (subject_.conditioning + bend))));
    check_start(answer.hit, at, exact, s, tally);
    if constexpr (requires { reference_.coordinates(p, line.d); })
      check_coordinates(answer.hit, ray, reference_.coordinates(p, line.d), s / cosine, tally);
  }

 private:
  /// Where a ray that leaves the hit starts must be on the side that it goes to, and hardly off the surface.
  void check_start(const Hit& hit, const WorldHit& at, const V& normal, double s, Tally& tally) {
    const double extent = world_extent(*scene_, hit);
    for (const bool shadow : {false, true}) {
      const Vec3 direction =
          normalize(dice_.direction() + std::pow(10.0, dice_.uniform(-3, 3)) * quad::rounded(normal));
      const double along = static_cast<double>(dot(normal, V(direction)));
      if (std::fabs(along) < 1e-6) continue;
      const RayStart start = secondary_start(at, direction, extent, shadow);
      const double height = static_cast<double>(reference_.height(chain_.inner_point(V(start.origin))));
      tally.wrong_side += !(height * along > 0);
      tally.start.push_back(static_cast<float>(std::fabs(height) / (kRoundoff * condition_ * s)));
    }
  }

  /// As lengths on the surface, against what a displacement of the hit by one unit does.
  void check_coordinates(const Hit& hit, const Ray& ray, const quad::Coordinates& exact, double unit,
                         Tally& tally) {
    const LocalHit local = resolve_local(*scene_, hit, ray, scratch_);
    const TextureCoordinates found = texture_coordinates(*scene_, hit, local.point, local.normal);
    Q du = abs(found.u - exact.u), dv = abs(found.v - exact.v);
    if (exact.cyclic_u) du = std::min(du, Q(abs(1 - du)));
    if (exact.cyclic_v) dv = std::min(dv, Q(abs(1 - dv)));
    const Q error = std::max(Q(du * exact.along_u), Q(dv * exact.along_v));
    tally.uv.push_back(static_cast<float>(static_cast<double>(error) / (kRoundoff * unit)));
  }

  Vec3 mark() {
    return subject_.marks[static_cast<std::size_t>(dice_.below(static_cast<int>(subject_.marks.size())))];
  }
  Vec3 outward(const Vec3& p) const { return quad::rounded(chain_.point(V(p))); }

  bool surface_point(V& p, V& n) {
    for (int attempt = 0; attempt < 50; ++attempt) {
      const Vec3 from = subject_.center + 3 * subject_.size * dice_.direction();
      const quad::Line line(Ray{from, subject_.center + dice_.in_box(.6 * subject_.size) - from});
      for (const quad::Crossing& c : all_crossings(reference_, line, 0).all) {
        if (!(c.inside > 0) || dice_.below(2)) continue;
        p = line.at(c.t);
        n = reference_.normal(p);
        return true;
      }
    }
    return false;
  }

  /// In the space of the shape, then taken outward and rounded there.
  Ray make_ray(Family family, double& lo) {
    const double size = subject_.size;
    Vec3 target = subject_.center + dice_.in_box(.7 * size);
    Vec3 origin = subject_.center + dice_.uniform(1.5, 5) * size * dice_.direction();
    if (!subject_.marks.empty() && dice_.below(2)) {  // within the hull of the shape, however thin
      const Vec3 a = mark(), b = mark(), c = mark();
      const double u = dice_.uniform(), v = dice_.uniform();
      target = a + u * (b - a) + (1 - u) * v * (c - a);
    }
    double stretch = std::pow(10.0, dice_.uniform(-3, 3));
    V p, n;
    switch (family) {
      case kFarAway:
        origin = subject_.center + std::pow(10.0, dice_.uniform(2, 8)) * size * dice_.direction();
        break;
      case kInside:
        origin = subject_.center + dice_.in_box(.4 * size);
        break;
      case kOnSurface:
        if (!surface_point(p, n)) break;
        origin = quad::rounded(p);
        target = origin + size * dice_.direction();
        lo = 1e-4;
        break;
      case kGrazing:
        if (!surface_point(p, n)) break;
        {
          const V any(dice_.direction());
          const V tangent = quad::unit(any - dot(any, n) * n);
          const auto small = [&](double least) {
            return Q((dice_.below(2) ? 1 : -1) * std::pow(10.0, -dice_.uniform(1, least)));
          };
          const V direction = tangent + small(14) * n, through = p + (small(15) * Q(size)) * n;
          origin = quad::rounded(through - Q(dice_.below(2) ? 2 * size : 1e4 * size) * direction);
          target = quad::rounded(through);
        }
        break;
      case kThroughMarks:
        if (!subject_.marks.empty()) target = mark();
        break;
      case kAxisParallel: {
        const auto zero = [&] { return dice_.below(2) ? 0.0 : -0.0; };
        Vec3 d{zero(), zero(), zero()};
        const int axis = dice_.below(3);
        d[axis] = dice_.below(2) ? 1 : -1;
        Vec3 from = outward(target);
        // Along an axis of the world, which is one of the shape where there is no chain.
        from[axis] -= 3 * size * d[axis] * chain_.growth();
        return {from, stretch * d};
      }
      case kExtreme:
        stretch = std::pow(10.0, dice_.uniform(-60, 60));
        break;
      default:
        break;
    }
    Ray ray{outward(origin), {}};
    const Vec3 d = outward(target) - ray.origin;
    ray.direction = stretch / max_abs(d) * d;
    if (family == kExtreme && dice_.below(2))
      ray.direction[dice_.below(3)] = dice_.below(2) ? 5e-324 : -2.5e-310;
    if (lo > 0) lo *= max_abs(d) / stretch;
    return ray;
  }

  const Reference& reference_;
  Subject subject_;
  Dice& dice_;
  Chain chain_;
  double inverse_growth_ = 1;
  double condition_ = 1;  ///< of what is taken outward: every map rounds
  std::unique_ptr<CompiledScene> scene_;
  std::unique_ptr<Intersector> world_;
  TraceScratch scratch_;
  int reported_ = 0;
};

/// What must hold: largest error of distance and normal, error of all but a ten-thousandth of (u, v), in the
/// units above, and how far rays may start off the surface.
struct Limits {
  float distance, normal, uv, start;
};

inline double largest(std::vector<float>& values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

class Report {
 public:
  Report(const std::string& name, int shapes)
      : table_(name, {"shape", "rays", "hits", "not decided", "false hits", "missed hits",
                      "distance: largest", "99.99 %", "normal: largest", "99.99 %", "(u, v): largest",
                      "99.99 %", "start on the wrong side", "off the surface, at most"}),
        shapes_(shapes) {
    std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  }

  /// `make(builder, dice, subject)` adds a shape and returns its node and its reference. One of `share` is
  /// taken, of shapes whose reference takes long.
  template <class Make>
  void run(const char* name, const Limits& limits, int share, const Make& make) {
    Dice dice(kSeed);
    Tally tally;
    for (int i = 0; i < (shapes_ + share - 1) / share; ++i) {
      SceneBuilder b;
      Subject subject;
      const auto [node, reference] = make(b, dice, subject);
      Trial trial(b, node, reference, subject, i % 3 == 0 ? 0 : 1 + dice.below(i % 3 == 1 ? 2 : 8), dice);
      for (int j = 0; j < 50; ++j) trial.shoot(tally);
    }
    const auto number = [](std::uint64_t n) { return format("%llu", static_cast<unsigned long long>(n)); };
    const auto both = [](std::vector<float>& values) {
      return std::pair{largest(values, 1), largest(values, .9999)};
    };
    const auto [d, dp] = both(tally.distance);
    const auto [n, np] = both(tally.normal);
    const auto [u, up] = both(tally.uv);
    const double off = largest(tally.start, 1);
    const bool mapped = !tally.uv.empty();
    table_.add(
        {name, number(tally.rays), number(tally.hits),
         format("%.2f %%", 100 * static_cast<double>(tally.undecided) / static_cast<double>(tally.rays)),
         number(tally.false_hits), number(tally.missed), format("%.2f", d), format("%.2f", dp),
         format("%.2f", n), format("%.2f", np), mapped ? format("%.2f", u) : "none",
         mapped ? format("%.2f", up) : "", number(tally.wrong_side), format("%.1f", off)});
    EXPECT_EQ(tally.false_hits, 0u) << name;
    EXPECT_EQ(tally.missed, 0u) << name;
    EXPECT_EQ(tally.wrong_side, 0u) << name;
    EXPECT_GT(tally.hits, tally.rays / 10) << name;
    EXPECT_LT(tally.undecided, tally.rays / 2) << name;
    EXPECT_LE(d, limits.distance) << name;
    EXPECT_LE(n, limits.normal) << name;
    EXPECT_LE(up, limits.uv) << name;
    EXPECT_LE(u, kRarely * limits.uv) << name;
    EXPECT_LE(off, limits.start) << name;
  }

 private:
  static constexpr std::uint64_t kSeed = 31;
  /// Among millions of hits are some where most roundings of (u, v) add up.
  static constexpr double kRarely = 3;
  Table table_;
  int shapes_;
};

}  // namespace rayshade::stress
