// SPDX-License-Identifier: MIT
// Reflected and transmitted rays (shading.md 2.3, 2.5).
#include <algorithm>
#include <cmath>

#include "rayshade/sampling/random.h"
#include "rayshade/shading/ray_tree_records.h"

namespace rayshade {
namespace {

bool any_above(const Color& c, const Color& limit) { return c.r > limit.r || c.g > limit.g || c.b > limit.b; }
bool any_above(const Color& c, double limit) { return c.r > limit || c.g > limit || c.b > limit; }

}  // namespace

/// Sections 2.3 steps 3 to 6 and 2.5.
void RayTree::spawn(Shade& shade) {
  const RenderSettings& settings = *scene_.settings;
  const Surface& surface = *shade.surface;
  const WorldHit& world = shade.world;
  Color reflect = surface.specular * surface.reflectance;
  const bool transmits = surface.transparency > kEpsilon;
  if (nodes_[shade.node].depth >= static_cast<std::uint32_t>(settings.max_depth)) {
    if (transmits || any_above(reflect, kEpsilon)) ++counts_.skipped_depth;
    return;
  }
  const auto child = [&](RayKind kind, RaySlot slot, const Vec3& direction, const Color& factor,
                         const Color& contribution) {
    const std::uint32_t id = allocate();
    Node& node = nodes_[shade.node];
    Node& out = nodes_[id];
    const double square = length_squared(direction);
    const bool unit = std::fabs(square - 1) < 1e-8;
    const RayStart start = shade.starts.toward(direction, unit ? 1 : std::sqrt(square), false);
    out.ray.origin = start.origin;
    out.ray.direction = direction;
    out.ray.time = node.ray.time;
    out.ray.unit = unit;
    out.lo = start.lo;
    out.contribution = contribution;
    out.path = child_path(node.path, slot);
    out.parent = shade.node;
    out.root = node.root;
    out.depth = node.depth + 1;
    out.kind = kind;
    out.slot = slot;
    out.children = out.waiting = 0;
    out.medium = node.medium;
    node.factor[slot] = factor;
    node.children = static_cast<std::uint8_t>(node.children | (1u << slot));
    ++node.waiting;
    return id;
  };

  std::uint32_t transmitted = kNone;
  if (transmits) {
    const Color filter = surface.body * surface.transparency;
    const Color contribution = filter * nodes_[shade.node].contribution;
    if (!any_above(contribution, settings.cutoff)) {
      ++counts_.skipped_cutoff;
    } else {
      const Node& node = nodes_[shade.node];
      const auto index_of = [&](std::uint32_t medium) {
        return medium == kNone ? settings.atmosphere_index : nodes_[medium].medium_index;
      };
      const double own_index = surface.index > 0 ? surface.index : 1;
      const std::uint32_t below = node.medium == kNone ? kNone : nodes_[node.medium].medium_below;
      const double n1 = world.entering ? index_of(node.medium) : own_index;
      const double n2 = world.entering ? own_index : index_of(below);
      const Vec3 normal = shade.k < 0 ? -world.normal : world.normal;
      const double k = std::fabs(shade.k);
      const double m = n1 / n2;
      const double s = 1 - m * m * (1 - k * k);
      if (s < 0) {
        ++counts_.total_reflections;
        reflect += filter;
      } else {
        const Vec3 direction = m * node.ray.direction + (m * k - std::sqrt(s)) * normal;
        if (is_finite(direction)) {
          transmitted = child(RayKind::kTransmitted, kTransmittedSlot, direction, filter, contribution);
          Node& out = nodes_[transmitted];
          if (world.entering) {
            out.medium_below = out.medium;
            out.medium_index = own_index;
            out.medium_extinction = surface.extinction;
            out.medium = transmitted;
          } else {
            out.medium = below;
          }
          nodes_[shade.node].child_extinction =
              out.medium == kNone ? 1 : nodes_[out.medium].medium_extinction;
          ++counts_.transmitted_rays;
        }
      }
    }
  }
  if (any_above(reflect, kEpsilon)) {
    const Color contribution = reflect * nodes_[shade.node].contribution;
    if (!any_above(contribution, settings.cutoff)) {
      ++counts_.skipped_cutoff;
    } else if (is_finite(shade.mirror)) {
      pending_.push_back(child(RayKind::kReflected, kReflectedSlot, shade.mirror, reflect, contribution));
      ++counts_.reflected_rays;
    }
  }
  if (transmitted != kNone) pending_.push_back(transmitted);
}

}  // namespace rayshade
