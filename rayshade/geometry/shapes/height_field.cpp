// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/height_field.h"

#include <array>
#include <limits>
#include <stdexcept>

namespace rayshade {
namespace {

constexpr double kUlp = std::numeric_limits<double>::epsilon();
/// Widening of cells and altitude ranges during the descent, relative to the numbers at hand: thousands of
/// roundings, so that no triangle that the exact test would accept is passed over.
constexpr double kMargin = 1e-12;
bool is_set(float altitude) { return HeightFieldData::is_set(altitude) && std::isfinite(altitude); }

struct Point2 {
  double x, y;
};

/// The sign of p x q, the side on which the origin lies of the line from p to q: exact, but 0 also where the
/// difference of the products is far below a rounding of either. Exchanging p and q negates it.
int side(const Point2& p, const Point2& q) {
  const double a = p.x * q.y, b = p.y * q.x;
  double difference = a - b;
  if (!(std::fabs(difference) > 4 * kUlp * (std::fabs(a) + std::fabs(b)))) {
    // a and b are so close that their difference is exact; add what their products rounded away.
    difference += std::fma(p.x, q.y, -a) - std::fma(p.y, q.x, -b);
  }
  return (difference > 0) - (difference < 0);
}

/// Not on both sides of some edge; triangles seen exactly edge-on hold nothing.
bool holds(int a, int b, int c) {
  return (a >= 0 && b >= 0 && c >= 0 && a + b + c > 0) || (a <= 0 && b <= 0 && c <= 0 && a + b + c < 0);
}

/// Of the sign that `d < 0` tells, so that -0 counts as forward here as in the descent.
double inverse_component(double d) {
  constexpr double kHuge = 1e290;
  const double inverse = 1 / d;
  return std::fabs(inverse) <= kHuge ? inverse : d < 0 ? -kHuge : kHuge;
}

}  // namespace

/// A ray in grid coordinates, and the nearest hit so far.
struct HeightField::Walk {
  Vec3 origin, direction;  ///< origin is moved along the ray to near the field
  double shift = 0;        ///< t = shift + x
  double lo, hi;
  Vec3 inverse;             ///< of the direction, finite
  Vec3 margin;              ///< absolute widening per axis
  double shear_1, shear_2;  ///< of the two minor axes by the major one
  double near, far;         ///< the ray's stay in the box
  double best_t;
  double best_x = 0;
  std::uint32_t best_part = 0;
  bool found = false;
};

HeightField::HeightField(std::shared_ptr<const HeightFieldData> data) : data_(std::move(data)) {
  const int size = data_->size;
  if (size < 2) throw std::invalid_argument("a height field needs at least 2 points per side");
  if (size > 46341) throw std::length_error("a height field may have at most 46341 points per side");
  if (data_->altitudes.size() != static_cast<std::size_t>(size) * size) {
    throw std::invalid_argument("a height field's altitudes do not fill its square");
  }
  cells_ = static_cast<std::uint32_t>(size) - 1;
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr Range kNothing{kInf, -kInf};
  std::uint32_t below = cells_;
  do {
    const std::uint32_t width = (below + 1) / 2, pairs = (width + 1) / 2;
    Level level{pairs, {}};
    level.ranges.assign(std::size_t{pairs} * pairs, {kNothing, kNothing, kNothing, kNothing});
    for (std::uint32_t j = 0; j < below; ++j) {
      for (std::uint32_t i = 0; i < below; ++i) {
        const Range part = levels_.empty() ? cell_range(i, j) : levels_.back().at(i, j);
        Range& whole = level.at(i / 2, j / 2);
        whole = {std::min(whole.lo, part.lo), std::max(whole.hi, part.hi)};
      }
    }
    levels_.push_back(std::move(level));
    below = width;
  } while (below > 1);
  const Range all = levels_.back().at(0, 0);
  bounds_ = {{0, 0, all.lo <= all.hi ? all.lo : 0}, {1, 1, all.lo <= all.hi ? all.hi : 0}};
}

HeightField::Range HeightField::cell_range(std::uint32_t i, std::uint32_t j) const {
  const float z00 = altitude(i, j), z10 = altitude(i + 1, j), z01 = altitude(i, j + 1),
              z11 = altitude(i + 1, j + 1);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  Range out{kInf, -kInf};
  if (!is_set(z10) || !is_set(z01)) return out;
  if (!is_set(z00) && !is_set(z11)) return out;
  out = {std::min(z10, z01), std::max(z10, z01)};
  if (is_set(z00)) out = {std::min(out.lo, z00), std::max(out.hi, z00)};
  if (is_set(z11)) out = {std::min(out.lo, z11), std::max(out.hi, z11)};
  return out;
}

HeightField::Facet HeightField::facet(std::uint32_t part) const {
  const std::uint32_t cell = part / 2, i = cell % cells_, j = cell / cells_;
  const double z10 = altitude(i + 1, j), z01 = altitude(i, j + 1);
  if (part % 2 == 0) {
    const double z00 = altitude(i, j);
    return {static_cast<double>(i), static_cast<double>(j), z00, z10 - z00, z01 - z00};
  }
  const double z11 = altitude(i + 1, j + 1);
  return {i + 1.0, j + 1.0, z11, z11 - z01, z11 - z10};
}

Vec3 HeightField::steepness(const Facet& f) const { return {-f.slope_x * cells_, -f.slope_y * cells_, 1}; }

bool HeightField::intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
  const double m = cells_;
  Walk walk;
  walk.origin = {ray.origin.x * m, ray.origin.y * m, ray.origin.z};
  walk.direction = {ray.direction.x * m, ray.direction.y * m, ray.direction.z};
  walk.lo = lo;
  walk.hi = walk.best_t = hi;
  const Vec3& d = walk.direction;
  walk.inverse = {inverse_component(d.x), inverse_component(d.y), inverse_component(d.z)};
  const Vec3 low{0, 0, bounds_.lo.z}, high{m, m, bounds_.hi.z};
  const auto clip = [&](const Vec3& margin) {
    walk.near = -Bounds3::kInf;
    walk.far = Bounds3::kInf;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (low[axis] - margin[axis] - walk.origin[axis]) * walk.inverse[axis];
      const double b = (high[axis] + margin[axis] - walk.origin[axis]) * walk.inverse[axis];
      walk.near = std::max(walk.near, std::min(a, b));
      walk.far = std::min(walk.far, std::max(a, b));
    }
    return walk.near <= walk.far;
  };
  // Start near the field: what is far away must not set the accuracy here.
  const double z_size = std::max(std::fabs(low.z), std::fabs(high.z));
  if (!clip({0.1 * m, 0.1 * m, 0.1 * (high.z - low.z) + 1e-9 * z_size})) return false;
  if (walk.far < lo || walk.near > hi) return false;
  if (walk.near > 0) {
    walk.shift = walk.near;
    walk.origin += walk.shift * d;
  }

  // Vertices are projected along the ray onto the plane of its two minor axes.
  const Vec3 size = abs(walk.origin) + Vec3{m, m, z_size};
  const Vec3 steep = abs(d);
  const int major = steep.x >= steep.y ? (steep.x >= steep.z ? 0 : 2) : (steep.y >= steep.z ? 1 : 2);
  if (!(steep[major] > 0)) return false;
  walk.shear_1 = d[(major + 1) % 3] / d[major];
  walk.shear_2 = d[(major + 2) % 3] / d[major];
  walk.margin = kMargin * (size + (size[major] / steep[major]) * steep);
  if (!clip(walk.margin)) return false;
  if (walk.shift + walk.far < lo || walk.shift + walk.near > hi) return false;
  switch (major) {
    case 0:
      descend<0>(walk);
      break;
    case 1:
      descend<1>(walk);
      break;
    default:
      descend<2>(walk);
      break;
  }
  if (!walk.found) return false;
  const std::uint32_t cell = walk.best_part / 2;
  const std::uint32_t column = cell % cells_, row = cell / cells_;
  const double x = walk.origin.x + walk.best_x * d.x - column;
  const double y = walk.origin.y + walk.best_x * d.y - row;
  hit = {walk.best_t, std::clamp(x, 0.0, 1.0), std::clamp(y, 0.0, 1.0), walk.best_part};
  return true;
}

template <int Axis>
void HeightField::descend(Walk& walk) const {
  struct Node {
    std::uint32_t level, i, j;  ///< level 0: cells
    double near, far;
  };
  // Three siblings wait on each of at most 17 levels.
  std::array<Node, 64> stack;  // NOLINT: filled as needed
  int top = 0;
  stack[0] = {static_cast<std::uint32_t>(levels_.size()), 0, 0, walk.near, walk.far};
  const Vec3 &o = walk.origin, &d = walk.direction;
  const double wide_x = walk.margin.x * std::fabs(walk.inverse.x),
               wide_y = walk.margin.y * std::fabs(walk.inverse.y);
  // The child that a ray reaches first is the one on the side it comes from.
  const std::uint32_t first_x = d.x < 0, first_y = d.y < 0;
  while (top >= 0) {
    const Node node = stack[top--];
    if (walk.shift + node.near > walk.best_t) continue;
    if (node.level == 0) {
      test_cell<Axis>(walk, node.i, node.j, node.near, node.far);
      continue;
    }
    const std::uint32_t level = node.level - 1;
    std::array<Range, 4> ranges;
    if (level > 0) {
      const Level& below = levels_[level - 1];
      ranges = below.ranges[std::size_t{node.j} * below.pairs + node.i];
    }
    // Planes in the order of the ray: entry, middle, exit. The far child's planes are the same numbers in the
    // next node along, and rounding is monotone: a child's stay lies within its parent's.
    const double cells = static_cast<double>(std::uint64_t{1} << level);
    const auto plane = [](double at, double origin, double inverse) { return (at - origin) * inverse; };
    double stay_x[2][2], stay_y[2][2];
    for (std::uint32_t k = 0; k < 2; ++k) {
      const double x0 = (2 * node.i + (k ^ first_x)) * cells, y0 = (2 * node.j + (k ^ first_y)) * cells;
      stay_x[k][0] = plane(first_x ? x0 + cells : x0, o.x, walk.inverse.x) - wide_x;
      stay_x[k][1] = plane(first_x ? x0 : x0 + cells, o.x, walk.inverse.x) + wide_x;
      stay_y[k][0] = plane(first_y ? y0 + cells : y0, o.y, walk.inverse.y) - wide_y;
      stay_y[k][1] = plane(first_y ? y0 : y0 + cells, o.y, walk.inverse.y) + wide_y;
    }
    // Pushed from back to front; of the two side children the one entered later goes first.
    const bool x_late = stay_x[1][0] > stay_y[1][0];
    const std::uint32_t order[4][2] = {{1, 1}, {x_late, !x_late}, {!x_late, x_late}, {0, 0}};
    for (const auto& [kx, ky] : order) {
      const std::uint32_t i = 2 * node.i + (kx ^ first_x), j = 2 * node.j + (ky ^ first_y);
      const double near = std::max({node.near, stay_x[kx][0], stay_y[ky][0]});
      const double far = std::min({node.far, stay_x[kx][1], stay_y[ky][1]});
      if (!(near <= far) || walk.shift + far < walk.lo || walk.shift + near > walk.best_t) continue;
      if (level == 0 && (i >= cells_ || j >= cells_)) continue;
      const Range range = level == 0 ? cell_range(i, j) : ranges[2 * (j % 2) + i % 2];
      const double z0 = o.z + near * d.z, z1 = o.z + far * d.z;
      if (std::max(z0, z1) + walk.margin.z < range.lo || std::min(z0, z1) - walk.margin.z > range.hi)
        continue;
      stack[++top] = {level, i, j, near, far};
    }
  }
}

template <int Axis>
void HeightField::test_cell(Walk& walk, std::uint32_t i, std::uint32_t j, double near, double far) const {
  const float z00 = altitude(i, j), z10 = altitude(i + 1, j), z01 = altitude(i, j + 1),
              z11 = altitude(i + 1, j + 1);
  const Vec3 &o = walk.origin, &d = walk.direction;
  const double x0 = i - o.x, x1 = (i + 1.0) - o.x, y0 = j - o.y, y1 = (j + 1.0) - o.y;
  const auto project = [&](double x, double y, float z) {
    const Vec3 v{x, y, z - o.z};
    constexpr int kFirst = (Axis + 1) % 3, kSecond = (Axis + 2) % 3;
    return Point2{v[kFirst] - walk.shear_1 * v[Axis], v[kSecond] - walk.shear_2 * v[Axis]};
  };
  const Point2 p10 = project(x1, y0, z10), p01 = project(x0, y1, z01);
  const int diagonal = side(p10, p01);

  struct Found {
    bool hit = false;
    double t = 0, x = 0;
  };
  const auto meet = [&](double x, double y, double z, double slope_x, double slope_y) {
    const double fall = d.z - slope_x * d.x - slope_y * d.y;
    // Clamped to the stay in the cell: what is not beyond it in the descent is not beyond it here. There is
    // no threshold for triangles that are almost edge-on: with the original's, rays would slip through them
    // where a neighbour across the edge is not. Those exactly edge-on were sorted out by their projection.
    Found out;
    out.x = fall != 0 ? std::clamp(((z - o.z) - slope_x * x - slope_y * y) / fall, near, far) : near;
    out.t = walk.shift + out.x;
    out.hit = out.t >= walk.lo && out.t > 0;
    return out;
  };

  Found best;
  std::uint32_t upper = 0;
  if (is_set(z10) && is_set(z01)) {
    if (is_set(z11)) {
      const Point2 p11 = project(x1, y1, z11);
      if (holds(side(p10, p11), side(p11, p01), -diagonal)) {
        const double z = z11;
        best = meet(x1, y1, z, z - z01, z - z10);
        upper = best.hit;
      }
    }
    // On the diagonal the upper triangle wins.
    if (is_set(z00) && !(best.hit && diagonal == 0)) {
      const Point2 p00 = project(x0, y0, z00);
      if (holds(side(p00, p10), diagonal, side(p01, p00))) {
        const double z = z00;
        const Found lower = meet(x0, y0, z, z10 - z, z01 - z);
        if (lower.hit && (!best.hit || lower.t < best.t)) best = lower, upper = 0;
      }
    }
  }
  if (!best.hit || best.t > walk.best_t) return;
  const std::uint32_t part = 2 * (j * cells_ + i) + upper;
  if (walk.found && best.t == walk.best_t && part > walk.best_part) return;
  walk.found = true;
  walk.best_t = best.t;
  walk.best_x = best.x;
  walk.best_part = part;
}

SurfacePoint HeightField::surface_point(const Ray& ray, const ShapeHit& hit) const {
  const Facet f = facet(hit.part);
  const double m = cells_;
  SurfacePoint out;
  out.normal = out.geometric_normal = normalize(steepness(f));
  Vec3 p = ray.at(hit.t);
  const double above =
      (p.z - f.corner_z) - f.slope_x * (p.x * m - f.corner_x) - f.slope_y * (p.y * m - f.corner_y);
  p -= out.normal * (above * out.normal.z);
  out.point = p;
  // `above` is rounded four times, of numbers up to |z|, and m |slope| (|x| + 1) for each slope; seen along
  // the normal that is times n_z, where n_z m |slope| <= 1. Moving the point rounds its coordinates.
  out.error =
      kUlp * (4 * (std::fabs(p.x) + std::fabs(p.y) + 2) + 3 * (std::fabs(p.z) + std::fabs(f.corner_z)));
  return out;
}

bool HeightField::entering(const Ray& ray, double /*lo*/, const ShapeHit& hit) const {
  return dot(steepness(facet(hit.part)), ray.direction) < 0;
}

TextureCoordinates HeightField::texture_coordinates(const Vec3& x, const Vec3&, const ShapeHit&) const {
  return {x.x, x.y, {1, 0, 0}, {0, 1, 0}};
}

}  // namespace rayshade
