// SPDX-License-Identifier: MIT
#include "fas/structure.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace fas {
namespace {

constexpr std::uint32_t kMostPrimitives = 1u << 27;
/// Rays go through the hierarchy one by one: trees spare them boxes as well as tests.
constexpr Choice::Saving kSaving{0.3, 0};

bool is_number(const Bounds& box) {
  for (std::size_t i = 0; i < 3; ++i)
    if (std::isnan(box.lo[i]) || std::isnan(box.hi[i])) return false;
  return true;
}
bool is_empty(const Bounds& box) {
  return box.lo[0] > box.hi[0] || box.lo[1] > box.hi[1] || box.lo[2] > box.hi[2];
}
bool is_finite(const Bounds& box) {
  for (std::size_t i = 0; i < 3; ++i)
    if (!std::isfinite(box.lo[i]) || !std::isfinite(box.hi[i])) return false;
  return true;
}
Bounds nowhere() {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  return {{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};
}

}  // namespace

class Structure::Parts::Bounded final : public HierarchyCandidates {
 public:
  explicit Bounded(const Parts& parts)
      : HierarchyCandidates(*parts.hierarchy, static_cast<std::uint32_t>(parts.order.size())),
        parts_(parts) {}
  void geometry(std::uint32_t place, Geometry& out) const override {
    out.one_sided = out.opaque = false;
    out.points.clear();
    parts_.primitives.geometry(parts_.order[place], out);
  }

 private:
  const Parts& parts_;
};

Structure::Parts::Parts(const Primitives& p, const Options& o) : primitives(p), options(o), pool(o.memory) {
  const std::uint32_t count = p.count();
  if (count >= kMostPrimitives) throw std::invalid_argument("fas: too many primitives");
  std::vector<std::uint32_t> bounded;
  std::vector<Bounds> boxes;
  Geometry geometry;
  for (std::uint32_t i = 0; i < count; ++i) {
    geometry.points.clear();
    p.geometry(i, geometry);
    if (!is_number(geometry.box)) throw std::invalid_argument("fas: a box is not a number");
    if (is_empty(geometry.box)) continue;
    if (!is_finite(geometry.box)) {
      unbounded.push_back(i);
      continue;
    }
    bounded.push_back(i);
    boxes.push_back(geometry.box);
  }
  if (bounded.empty()) return;
  const std::vector<std::uint8_t> masks(bounded.size(), 1);
  hierarchy = std::make_unique<Hierarchy>(std::move(boxes), masks, o.threads, order);
  for (std::uint32_t& place : order) place = bounded[place];
  candidates = std::make_unique<Bounded>(*this);
}

RayClass Structure::Parts::add(Class rays) {
  const auto number = static_cast<std::uint32_t>(classes.size());
  classes.push_back(std::move(rays));
  plant(classes.back(), number);
  return {number};
}

void Structure::Parts::plant(Class& rays, std::uint32_t number) {
  if (!hierarchy) return;
  const Split split = options.always_split ? Split::kAlways : Split::kAdaptive;
  if (rays.is_flat())
    rays.flat = std::make_unique<HyperTree>(rays.view, *candidates, pool, tuner, number, split);
  else
    rays.beams =
        std::make_unique<BeamTree>(*hierarchy, rays.origins, options.condition, pool, tuner, number, split);
  rays.choice = std::make_unique<Choice>(
      options.expected_rays, rays.is_flat() ? Choice::kMakePrimitive * static_cast<double>(order.size()) : 0,
      kSaving);
}

Structure::Structure(const Primitives& primitives, const Options& options)
    : parts_(std::make_unique<Parts>(primitives, options)) {}
Structure::~Structure() = default;

RayClass Structure::rays_from(const Point& point) {
  Parts::Class rays;
  rays.kind = Parts::Class::Kind::kFromPoint;
  rays.view = make_view(View::Kind::kPoint, point, bounds(), parts_->options.condition);
  return parts_->add(std::move(rays));
}

RayClass Structure::rays_toward(const Point& point) {
  Parts::Class rays;
  rays.kind = Parts::Class::Kind::kToward;
  rays.view = make_view(View::Kind::kPoint, point, bounds(), parts_->options.condition);
  return parts_->add(std::move(rays));
}

RayClass Structure::rays_along(const Point& direction) {
  Parts::Class rays;
  rays.kind = Parts::Class::Kind::kToward;
  rays.view = make_view(View::Kind::kParallel, direction, bounds(), parts_->options.condition);
  return parts_->add(std::move(rays));
}

RayClass Structure::rays_from(const Bounds& box) {
  Parts::Class rays;
  rays.kind = Parts::Class::Kind::kFromBox;
  rays.origins = box;
  return parts_->add(std::move(rays));
}

RayClass Structure::rays_toward(const Bounds& box) {
  Parts::Class rays;
  rays.kind = Parts::Class::Kind::kTowardBox;
  rays.origins = box;
  return parts_->add(std::move(rays));
}

RayClass Structure::rays() {
  Parts::Class rays;
  rays.origins = bounds();
  return parts_->add(std::move(rays));
}

Bounds Structure::bounds() const { return parts_->hierarchy ? parts_->hierarchy->bounds() : nowhere(); }

void Structure::clear() {
  parts_->pool.reset();
  for (std::uint32_t i = 0; i < parts_->classes.size(); ++i) parts_->plant(parts_->classes[i], i);
}

std::size_t Structure::hierarchy_bytes() const { return parts_->hierarchy ? parts_->hierarchy->bytes() : 0; }
std::size_t Structure::tree_bytes() const { return parts_->pool.used(); }

}  // namespace fas
