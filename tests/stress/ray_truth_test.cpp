// SPDX-License-Identifier: MIT
// The truth of single rays: whole queries - transform chains, shapes, normals in the world - against the
// equations in 113 bits, on rays that are ordinary and rays that hurt.
//
// Distances and normals are measured in units of what one rounding of the numbers at hand must cost:
// kRoundoff times the largest size that takes part (of the ray, the chain of transforms and the shape, in the
// space of the shape), over the cosine under which the ray meets the surface; near tangency this cosine is
// that of a ray displaced by as much. A hit or miss counts as decided where no change of the ray by a few
// hundred units could alter it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "rayshade/geometry/resolve.h"
#include "rayshade/geometry/shapes/rounding.h"
#include "tests/stress/markdown.h"
#include "tests/unit/geometry/scene_builder.h"
#include "tests/unit/geometry/shapes_quad.h"

namespace rayshade::stress {
namespace {

using quad::Q;
using quad::V;
using test::Dice;
using test::SceneBuilder;

constexpr double kDecided = 300;

/// p' = p.x rows[0] + p.y rows[1] + p.z rows[2] + shift, and its inverse by cross products.
struct Chain {
  V rows[3] = {V(1, 0, 0), V(0, 1, 0), V(0, 0, 1)}, shift{0, 0, 0};

  V vector(const V& p) const { return p.x * rows[0] + p.y * rows[1] + p.z * rows[2]; }
  V point(const V& p) const { return vector(p) + shift; }
  void append(const Affine& map) {
    Chain next;
    for (int i = 0; i < 3; ++i) next.rows[i] = V(map.rows[i]);
    next.shift = V(map.translation);
    for (V& row : rows) row = next.vector(row);
    shift = next.point(shift);
  }
  /// Gradients of the inner coordinates in the outer space.
  V gradient(int i) const {
    const V across = cross(rows[(i + 1) % 3], rows[(i + 2) % 3]);
    return (1 / dot(rows[i], across)) * across;
  }
  V inner_vector(const V& p) const { return {dot(p, gradient(0)), dot(p, gradient(1)), dot(p, gradient(2))}; }
  V outer_normal(const V& n) const {
    return quad::unit(n.x * gradient(0) + n.y * gradient(1) + n.z * gradient(2));
  }
  double growth() const {
    return static_cast<double>(quad::length(rows[0]) + quad::length(rows[1]) + quad::length(rows[2]));
  }
  double inverse_growth() const {
    return static_cast<double>(quad::length(gradient(0)) + quad::length(gradient(1)) +
                               quad::length(gradient(2)));
  }
};

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

struct Subject {
  Vec3 center;
  double size = 1, conditioning = 1;  ///< as in shapes_accuracy_test.cpp
  std::vector<Vec3> marks;            ///< vertices and points of edges
};

struct Tally {
  std::uint64_t rays = 0, hits = 0, undecided = 0, false_hits = 0, missed = 0;
  std::vector<float> distance, normal;
};

template <class Reference>
class Trial {
 public:
  Trial(SceneBuilder& b, NodeId shape, const Reference& reference, Subject subject, int depth, Dice& dice)
      : reference_(reference), subject_(std::move(subject)), dice_(dice) {
    for (int i = 0; i < depth; ++i) {
      const auto factor = [&] { return (dice.below(2) ? 1 : -1) * fn::exp(dice.uniform(-1.2, 1.2)); };
      Affine map = scaling({factor(), factor(), factor()});
      map = then(map, test::about(dice.direction(), dice.uniform(0, 360)));
      map = then(map, translation(dice.in_box(3 * subject_.size)));
      chain_.append(map);
      shape = b.list({b.moved(shape, map)});
    }
    b.show(shape);
    scene_ = b.compile();
    world_ = make_brute_force(*scene_);
    inverse_growth_ = chain_.inverse_growth();
    condition_ = std::max(1.0, chain_.growth() * inverse_growth_ / 9);
  }

  void shoot(Tally& tally) {
    double lo = 0;
    const Ray ray = make_ray(static_cast<Family>(dice_.below(kFamilies)), lo);
    Ray inner_ray;
    quad::Line line(inner_ray);
    line.o = chain_.inner_vector(V(ray.origin) - chain_.shift);
    line.d = chain_.inner_vector(V(ray.direction));
    const double speed = static_cast<double>(quad::length(line.d));
    const quad::Crossings crossings = reference_.crossings(line);
    ++tally.rays;
    const double outer = length(ray.origin) + static_cast<double>(quad::length(chain_.shift)),
                 base = static_cast<double>(quad::length(line.o - V(subject_.center))) + subject_.size +
                        length(subject_.center);
    const auto sizes = [&](const Q& t) {
      const double far = std::fabs(static_cast<double>(t));
      return subject_.conditioning *
             (base + far * speed + inverse_growth_ * (outer + far * length(ray.direction)));
    };
    const auto effective_cosine = [&](const quad::Crossing& c) {
      const double floor =
          c.curvature > 0 ? std::sqrt(kRoundoff * sizes(c.t) / static_cast<double>(c.curvature)) : 0;
      return std::clamp(static_cast<double>(c.cosine), std::min(floor, 1.0), 1.0);
    };
    const quad::Crossing* expected = nullptr;
    bool decided = crossings.from_tangency > kDecided * kRoundoff * sizes(0);
    for (const quad::Crossing& c : crossings.all) {
      const double reach = kDecided * kRoundoff * sizes(c.t) / effective_cosine(c);
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
    if (wrong && reported_++ < 3) {
      ADD_FAILURE() << (answer.found ? "false hit" : "missed hit")
                    << format(": origin %a %a %a direction %a %a %a lo %a, found %g instead of %g",
                              ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y,
                              ray.direction.z, lo, answer.found ? answer.hit.t() : -1,
                              expected ? static_cast<double>(expected->t) : -1);
    }
    tally.false_hits += wrong && answer.found;
    tally.missed += wrong && !answer.found;
    if (!answer.found || wrong) return;
    ++tally.hits;
    const double s = sizes(expected->t), cosine = effective_cosine(*expected);
    tally.distance.push_back(static_cast<float>(static_cast<double>(abs(Q(answer.hit.t()) - expected->t)) *
                                                speed * cosine / (kRoundoff * s)));
    if (expected->inside < 1e-4 * subject_.size) return;  // normals of boxes change near their edges
    const WorldHit at = resolve_world(*scene_, answer.hit, ray, scratch_);
    const V exact = chain_.outer_normal(reference_.normal(line.at(expected->t)));
    const double turn = std::min(static_cast<double>(quad::length(V(at.normal) - exact)),
                                 static_cast<double>(quad::length(V(at.normal) + exact)));
    const double bend = expected->turning > 0 ? s / (static_cast<double>(expected->turning) * cosine) : 0;
    tally.normal.push_back(
        static_cast<float>(turn / (kRoundoff * condition_ * (subject_.conditioning + bend))));
  }

 private:
  Vec3 mark() {
    return subject_.marks[static_cast<std::size_t>(dice_.below(static_cast<int>(subject_.marks.size())))];
  }
  Vec3 outward(const Vec3& p) const { return quad::rounded(chain_.point(V(p))); }

  bool surface_point(V& p, V& n) {
    for (int attempt = 0; attempt < 50; ++attempt) {
      const Vec3 from = subject_.center + 3 * subject_.size * dice_.direction();
      const quad::Line line(Ray{from, subject_.center + dice_.in_box(.6 * subject_.size) - from});
      for (const quad::Crossing& c : reference_.crossings(line).all) {
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
  double inverse_growth_ = 1, condition_ = 1;
  std::unique_ptr<CompiledScene> scene_;
  std::unique_ptr<Intersector> world_;
  TraceScratch scratch_;
  int reported_ = 0;
};

/// What must hold: largest error of distance and normal in the units above.
struct Limits {
  float distance, normal;
};

double largest(std::vector<float>& values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

class Report {
 public:
  Report(const std::string& name, int shapes)
      : table_(name, {"shape", "rays", "hits", "not decided", "false hits", "missed hits",
                      "distance: largest", "99.99 %", "normal: largest", "99.99 %"}),
        shapes_(shapes) {
    std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  }

  /// `make(builder, dice, subject)` adds a shape and returns its node and its reference.
  template <class Make>
  void run(const char* name, const Limits& limits, const Make& make) {
    Dice dice(kSeed);
    Tally tally;
    for (int i = 0; i < shapes_; ++i) {
      SceneBuilder b;
      Subject subject;
      const auto [node, reference] = make(b, dice, subject);
      Trial trial(b, node, reference, subject, i % 3 == 0 ? 0 : 1 + dice.below(i % 3 == 1 ? 2 : 8), dice);
      for (int j = 0; j < 50; ++j) trial.shoot(tally);
    }
    const auto number = [](std::uint64_t n) { return format("%llu", static_cast<unsigned long long>(n)); };
    const double d = largest(tally.distance, 1), dp = largest(tally.distance, .9999),
                 n = largest(tally.normal, 1), np = largest(tally.normal, .9999);
    table_.add(
        {name, number(tally.rays), number(tally.hits),
         format("%.2f %%", 100 * static_cast<double>(tally.undecided) / static_cast<double>(tally.rays)),
         number(tally.false_hits), number(tally.missed), format("%.2f", d), format("%.2f", dp),
         format("%.2f", n), format("%.2f", np)});
    EXPECT_EQ(tally.false_hits, 0u) << name;
    EXPECT_EQ(tally.missed, 0u) << name;
    EXPECT_GT(tally.hits, tally.rays / 10) << name;
    EXPECT_LT(tally.undecided, tally.rays / 2) << name;
    EXPECT_LE(d, limits.distance) << name;
    EXPECT_LE(np, limits.normal) << name;
    EXPECT_LE(n, kRarely * limits.normal) << name;
  }

 private:
  static constexpr std::uint64_t kSeed = 31;
  /// Normals are taken outward map by map, up to nine times, and every map rounds: among millions of hits are
  /// some where most of that adds up.
  static constexpr double kRarely = 3;
  Table table_;
  int shapes_;
};

/// The torus by its distance function, and all places where that changes sign.
class Torus {
 public:
  explicit Torus(const shape::Torus& torus)
      : center_(torus.center), axis_(quad::unit(V(torus.axis))), swept_(torus.swept), tube_(torus.tube) {}

  quad::Crossings crossings(const quad::Line& line) const {
    const Q speed = quad::length(line.d), middle = dot(center_ - line.o, line.d) / (speed * speed);
    const Q reach = 1.01 * (swept_ + tube_) / speed;
    quad::Crossings out;
    // Where a tube thicker or thinner by a little is met more or less often, the line nearly touches it.
    const Q little = 3e-5 * tube_;
    const auto count = [&](const Q& tube) {
      std::vector<Q> found;
      search(line, tube, middle - reach, middle + reach, 1e-3 * tube_ / speed, speed, found);
      return found;
    };
    const std::vector<Q> found = count(tube_);
    if (count(tube_ - little).size() != count(tube_ + little).size()) out.from_tangency = 0;
    for (const Q& t : found) {
      const V p = line.at(t), n = normal(p);
      // At least the smaller of the two principal radii, whichever way the line goes.
      const Q inner = std::min(tube_, Q(abs(swept_ - tube_)));
      out.all.push_back({t, 1e300, abs(dot(n, line.d)) / speed, inner, inner});
    }
    return out;
  }
  V normal(const V& p) const { return quad::unit(p - ring(p)); }

 private:
  /// The nearest point of the circle.
  V ring(const V& p) const {
    const V q = p - center_;
    return center_ + swept_ * quad::unit(q - dot(q, axis_) * axis_);
  }
  Q distance(const V& p, const Q& tube) const { return quad::length(p - ring(p)) - tube; }
  void search(const quad::Line& line, const Q& tube, Q a, Q b, const Q& width, const Q& speed,
              std::vector<Q>& out) const {
    const Q middle = (a + b) / 2;
    if (abs(distance(line.at(middle), tube)) > speed * (b - a) / 2) return;
    if (b - a > width) {
      search(line, tube, a, middle, width, speed, out);
      search(line, tube, middle, b, width, speed, out);
      return;
    }
    const bool positive = distance(line.at(a), tube) > 0;
    if (positive == (distance(line.at(b), tube) > 0)) return;
    for (int i = 0; i < 90; ++i) {
      const Q x = (a + b) / 2;
      ((distance(line.at(x), tube) > 0) == positive ? a : b) = x;
    }
    out.push_back((a + b) / 2);
  }

  V center_, axis_;
  Q swept_, tube_;
};

double any_scale(Dice& dice) { return std::pow(10.0, dice.below(3) ? 0 : dice.uniform(-6, 6)); }

void all_shapes(const std::string& name, int shapes) {
  Report report(name, shapes);
  const auto place = [](Dice& dice, double s) {
    return s * (dice.below(2) ? 1 : std::pow(10.0, dice.uniform(0, 6))) * dice.in_box(1);
  };
  report.run("sphere", {4, 4}, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const shape::Sphere sphere{s, place(dice, s)};
    subject = {sphere.center, s, 1, {}};
    return std::pair{b.sphere(sphere.radius, sphere.center), quad::Sphere(sphere)};
  });
  report.run("box", {4, 4}, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const Vec3 lo = place(dice, s);
    const shape::Box box{lo, lo + s * Vec3{dice.uniform(.2, 1), dice.uniform(.2, 1), dice.uniform(.2, 1)}};
    subject = {.5 * (box.lo + box.hi),
               .6 * s,
               1,
               {box.lo, box.hi, {box.lo.x, box.hi.y, .5 * (box.lo.z + box.hi.z)}}};
    return std::pair{b.box(box.lo, box.hi), quad::Box(box)};
  });
  report.run("plane", {4, 10}, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const shape::Plane plane{place(dice, s), dice.direction()};
    subject = {plane.point, s, 1, {}};
    return std::pair{b.plane(plane.point, plane.normal), quad::Plane(plane)};
  });
  report.run("disc", {4, 4}, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const shape::Disc disc{s, place(dice, s), dice.direction()};
    subject = {disc.center, s, 1, {}};
    return std::pair{b.disc(disc.radius, disc.center, disc.normal), quad::Disc(disc)};
  });
  const auto triangle = [&](double thinnest) {
    return [=](SceneBuilder& b, Dice& dice, Subject& subject) {
      const double s = any_scale(dice);
      const Vec3 at = place(dice, s), along = s * dice.direction(), across = s * dice.direction();
      const double thin = std::pow(10.0, -dice.uniform(0, thinnest));
      const Vec3 p[3] = {at, at + along, at + dice.uniform(.1, .9) * along + thin * across};
      const Vec3 e1 = p[1] - p[0], e2 = p[2] - p[1];
      // What the roundings of the corners cost the plane.
      const double turned = length(e1) * length(e2) / length(cross(e1, e2));
      subject = {
          (p[0] + p[1] + p[2]) / 3, s, turned, {p[0], p[1], p[2], .5 * (p[0] + p[1]), .5 * (p[1] + p[2])}};
      return std::pair{b.triangle(p[0], p[1], p[2]), quad::Polygon({p[0], p[1], p[2]})};
    };
  };
  report.run("triangle", {4, 4}, triangle(.5));
  report.run("needle triangle", {4, 4}, triangle(5));
  report.run("polygon", {4, 6}, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const Vec3 at = place(dice, s);
    Vec3 e1, e2;
    coordinate_system(dice.direction(), e1, e2);
    std::vector<Vec3> points;
    const int count = 3 + dice.below(20);
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * fn::kPi * i / count, radius = s * dice.uniform(.3, 1);
      points.push_back(at + radius * (fn::cos(angle) * e1 + fn::sin(angle) * e2));
    }
    subject = {at, s, 1, points};
    return std::pair{b.polygon(points), quad::Polygon(points)};
  });
  const auto axis = [](Dice& dice) {
    if (dice.below(3) == 0) return Vec3{0, 0, dice.below(2) ? 1.0 : -1.0};
    if (dice.below(3) == 0)
      return normalize(Vec3{0, 0, 1} + std::pow(10.0, -dice.uniform(2, 12)) * dice.direction());
    return dice.direction();
  };
  report.run("cylinder", {6, 8}, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const Vec3 bottom = place(dice, s), top = bottom + s * axis(dice);
    const shape::Cylinder cylinder{s * dice.uniform(.1, 1), bottom, top};
    subject = {.5 * (bottom + top), s, 1, {}};
    return std::pair{b.cylinder(cylinder.radius, bottom, top), quad::Wall(cylinder)};
  });
  report.run("cone, some nearly a cylinder", {8, 8}, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const Vec3 bottom = place(dice, s), top = bottom + s * axis(dice);
    const double r = s * dice.uniform(.2, 1);
    const double other = dice.below(3) == 0   ? 0
                         : dice.below(2) == 0 ? r * (1 - std::pow(10.0, -dice.uniform(1, 4)))
                                              : r * dice.uniform(.1, 1);
    const shape::Cone cone{r, bottom, other, top};
    subject = {.5 * (bottom + top), s, 1, {}};
    return std::pair{b.cone(r, bottom, other, top), quad::Wall(cone)};
  });
  report.run("torus, some thin", {8, 8}, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const shape::Torus torus{s, s * std::pow(10.0, -dice.uniform(.3, 3)), place(dice, s), axis(dice)};
    subject = {torus.center, s, 1, {}};
    Vec3 u, w;
    coordinate_system(torus.axis, u, w);
    for (int i = 0; i < 12; ++i) {
      const double angle = 2 * fn::kPi * dice.uniform();
      subject.marks.push_back(torus.center + (s + torus.tube * dice.uniform(-.9, .9)) *
                                                 (fn::cos(angle) * u + fn::sin(angle) * w));
    }
    return std::pair{b.torus(torus.swept, torus.tube, torus.center, torus.axis), Torus(torus)};
  });
}

TEST(RayTruthTest, ShapesThroughTransforms) { all_shapes("truth-short", 25); }

TEST(RayTruthTest, DISABLED_ShapesThroughTransformsLong) {
  all_shapes("truth", static_cast<int>(scaled_count(6000)));
}

}  // namespace
}  // namespace rayshade::stress
