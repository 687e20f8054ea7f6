// SPDX-License-Identifier: MIT
// What depends on the frame: bounds over its shutter interval, the order of leaves, the hierarchies. Groups
// are done bottom up, each after all that its leaves refer to.
#include <algorithm>

#include "fas/hierarchy.h"
#include "rayshade/geometry/compiled_scene.h"
#include "rayshade/geometry/csg_pack.h"
#include "rayshade/geometry/rank.h"
#include "rayshade/geometry/resolve.h"

namespace rayshade {
namespace {

/// Looping over this many bounded leaves costs no more than a hierarchy over them.
constexpr std::size_t kLoopLeaves = 4;

double norm(const Affine& map) {
  const auto row = [](const Vec3& v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); };
  return std::max({row(map.rows[0]), row(map.rows[1]), row(map.rows[2])});
}

/// Which hits CSG can give (objects.md 7.13). An operand that is `solid` holds the other's hits inside its
/// own box: only of such may boxes be intersected, since open or overlapping operands report hits anywhere on
/// the other one.
Bounds3 csg_rule(NodeKind operation, const Bounds3& left, bool left_solid, const Bounds3& right,
                 bool right_solid) {
  switch (operation) {
    case NodeKind::kUnion:
      return join(left, right);
    case NodeKind::kDifference:
      return left_solid ? left : join(left, right);
    default:
      if (left_solid && right_solid) return intersection(left, right);
      if (left_solid || right_solid) return left_solid ? left : right;
      return join(left, right);
  }
}

}  // namespace

Bounds3 CompiledScene::shape_bounds(const Leaf& leaf) const {
  switch (leaf.kind) {
    case LeafKind::kPlane:
      return planes[leaf.shape].bounds();
    case LeafKind::kSphere:
      return spheres[leaf.shape].bounds();
    case LeafKind::kBox:
      return boxes[leaf.shape].bounds();
    case LeafKind::kDisc:
      return discs[leaf.shape].bounds();
    case LeafKind::kCylinder:
      return cylinders[leaf.shape].bounds();
    case LeafKind::kCone:
      return cones[leaf.shape].bounds();
    case LeafKind::kTorus:
      return tori[leaf.shape].bounds();
    case LeafKind::kTriangle:
      return triangles[leaf.shape].bounds();
    case LeafKind::kSmoothTriangle:
      return smooth_triangles[leaf.shape].bounds();
    case LeafKind::kUvTriangle:
      return uv_triangles[leaf.shape].bounds();
    case LeafKind::kPolygon:
      return polygons[leaf.shape].bounds();
    case LeafKind::kBlob:
      return blobs[leaf.shape].bounds();
    case LeafKind::kHeightField:
      return height_fields[leaf.shape].bounds();
    case LeafKind::kCsg:
    case LeafKind::kInstance:
      break;
  }
  return {};
}

Bounds3 CompiledScene::group_bounds(std::uint32_t group) const {
  return groups[group].unbounded > 0 ? Bounds3::everything() : groups[group].bounds;
}

Bounds3 CompiledScene::csg_bounds(const Csg& csg) const {
  Bounds3 left = group_bounds(csg.left), right = group_bounds(csg.right);
  const bool left_solid = groups[csg.left].solid, right_solid = groups[csg.right].solid;
  // Where solids touch, a hit may be off by the tolerance of `next`, which is at most 1e-5 of their extent.
  if (left_solid) left = grown(left, 4 * kEpsilon * left.largest_extent());
  if (right_solid) right = grown(right, 4 * kEpsilon * right.largest_extent());
  return csg_rule(csg.operation, left, left_solid, right, right_solid);
}

Bounds3 CompiledScene::leaf_bounds(LeafId id, const Interval& time, double frame_number) const {
  const Leaf& leaf = leaves[id];
  if (leaf.kind == LeafKind::kCsg) return csg_bounds(csgs[leaf.shape]);
  Bounds3 box =
      leaf.kind == LeafKind::kInstance ? group_bounds(instances[leaf.shape].group) : shape_bounds(leaf);
  if (leaf.placement == kNone) return box;
  const Placement& placement = placements[leaf.placement];
  if (!placement.animated()) return transformed(box, placement.map.forward);
  for (const TransformList* list : placement.lists) box = list->motion_bounds(box, time, frame_number);
  return box;
}

double CompiledScene::leaf_extent(LeafId id) const {
  const Leaf& leaf = leaves[id];
  Bounds3 box;
  if (leaf.kind == LeafKind::kCsg) {
    box = csg_bounds(csgs[leaf.shape]);
  } else {
    box = leaf.kind == LeafKind::kInstance ? group_bounds(instances[leaf.shape].group) : shape_bounds(leaf);
    if (leaf.placement != kNone) box = transformed(box, placements[leaf.placement].map.forward);
  }
  return box.unbounded() ? scale : box.largest_extent();
}

double CompiledScene::leaf_condition(const Leaf& leaf) const {
  double condition = 1;
  if (leaf.kind == LeafKind::kCsg) {
    const Csg& csg = csgs[leaf.shape];
    condition = std::max(groups[csg.left].condition, groups[csg.right].condition);
  } else if (leaf.kind == LeafKind::kInstance) {
    condition = groups[instances[leaf.shape].group].condition;
  }
  if (leaf.placement != kNone) {
    const AffinePair& map = placements[leaf.placement].map;
    condition *= std::max(1.0, norm(map.forward) * norm(map.inverse));
  }
  return condition;
}

bool CompiledScene::prepare_frame(const Interval& new_shutter, double new_frame, bool hierarchies) {
  const bool same = shutter.lo == new_shutter.lo && shutter.hi == new_shutter.hi && frame == new_frame;
  shutter = new_shutter;
  frame = new_frame;
  if (!has_motion || same) return false;
  rebuild(hierarchies);
  return true;
}

void CompiledScene::rebuild(bool hierarchies) {
  place_animated();
  for (const std::uint32_t group : bottom_up) rebuild_group(groups[group], hierarchies);
  scale = groups[0].bounds.largest_extent();
  if (!(scale > 0) || !std::isfinite(scale)) scale = 1;
  if (has_csg) {
    set_tolerances();
    choose_csg_for_packs(*this);
  }
  measure_extents();
  count_bytes();
}

/// For scenes whose table is small beside their leaves' use.
void CompiledScene::measure_extents() {
  constexpr std::size_t kMost = std::size_t{1} << 17;
  leaf_extents.clear();
  if (leaves.size() > kMost) return;
  std::vector<double> extents(leaves.size(), 0);
  Hit hit;
  for (hit.leaf = 0; hit.leaf < leaves.size(); ++hit.leaf) {
    const LeafKind kind = leaves[hit.leaf].kind;
    if (kind != LeafKind::kCsg && kind != LeafKind::kInstance) extents[hit.leaf] = world_extent(*this, hit);
  }
  leaf_extents = std::move(extents);
}

/// Animated placements as they are at the start of the frame.
void CompiledScene::place_animated() {
  for (Placement& placement : placements) {
    if (!placement.animated()) continue;
    placement.map = {};
    for (const TransformList* list : placement.lists) {
      placement.map.forward = then(placement.map.forward, list->at({shutter.lo, frame}));
    }
    const auto inverted = inverse(placement.map.forward);
    if (inverted) placement.map.inverse = *inverted;
  }
}

/// EPS of objects.md 7.2, relative for objects smaller than one unit in their own space. Planes have no size:
/// among bounded things they take that of these, alone that of the world.
void CompiledScene::set_tolerances() {
  // Boxes of operands and of shared groups, with animated parts as they are at the start of the frame; and of
  // what is bounded in them.
  std::vector<Bounds3> resting(groups.size()), bounded(groups.size());
  const auto result = [&](const Csg& csg) {
    return csg_rule(csg.operation, resting[csg.left], groups[csg.left].solid, resting[csg.right],
                    groups[csg.right].solid);
  };
  const auto bounded_result = [&](const Csg& csg) {
    const Bounds3 box = result(csg);
    return box.unbounded() ? join(bounded[csg.left], bounded[csg.right]) : box;
  };
  for (const std::uint32_t index : bottom_up) {
    if (index == 0) continue;
    const Group& group = groups[index];
    for (LeafId id = group.first; id < group.first + group.count; ++id) {
      const Leaf& leaf = leaves[id];
      Bounds3 box, part;
      if (leaf.kind == LeafKind::kCsg) {
        box = result(csgs[leaf.shape]);
        part = bounded_result(csgs[leaf.shape]);
      } else {
        const bool shared = leaf.kind == LeafKind::kInstance;
        box = shared ? resting[instances[leaf.shape].group] : shape_bounds(leaf);
        part = shared ? bounded[instances[leaf.shape].group] : box.unbounded() ? Bounds3{} : box;
        if (leaf.placement != kNone) {
          box = transformed(box, placements[leaf.placement].map.forward);
          part = transformed(part, placements[leaf.placement].map.forward);
        }
      }
      if (!box.empty()) resting[index].add(box);
      if (!part.empty()) bounded[index].add(part);
    }
  }
  for (Csg& csg : csgs) {
    const bool planes_alone = result(csg).unbounded() && bounded_result(csg).empty();
    Bounds3 box = bounded_result(csg);
    if (csg.placement != kNone && !box.empty()) box = transformed(box, placements[csg.placement].map.inverse);
    double extent = box.largest_extent();
    if (planes_alone)
      extent = scale * (csg.placement == kNone ? 1 : norm(placements[csg.placement].map.inverse));
    csg.tolerance = kEpsilon * (extent > 0 ? std::min(1.0, extent) : 1.0);
  }
}

void CompiledScene::rebuild_group(Group& group, bool hierarchies) {
  group.bounds = {};
  group.hierarchy.reset();
  group.condition = 1;
  std::vector<LeafId> unbounded, bounded, empty;
  std::vector<fas::Bounds> leaf_boxes;
  leaf_boxes.reserve(group.count);
  bounded.reserve(group.count);
  for (LeafId id = group.first; id < group.first + group.count; ++id) {
    group.condition = std::max(group.condition, leaf_condition(leaves[id]));
    const Bounds3 box = leaf_bounds(id, shutter, frame);
    if (box.empty()) {
      empty.push_back(id);
    } else if (box.unbounded()) {
      unbounded.push_back(id);
    } else {
      group.bounds.add(box);
      bounded.push_back(id);
      leaf_boxes.push_back({{box.lo.x, box.lo.y, box.lo.z}, {box.hi.x, box.hi.y, box.hi.z}});
    }
  }
  const Vec3 &lo = group.bounds.lo, &hi = group.bounds.hi;
  group.clip_box = fas::ClipBox({{lo.x, lo.y, lo.z}, {hi.x, hi.y, hi.z}});
  group.unbounded = static_cast<std::uint32_t>(unbounded.size());
  group.few_simple =
      bounded.size() + empty.size() <= 2 && std::all_of(bounded.begin(), bounded.end(), [&](LeafId id) {
        const Leaf& leaf = leaves[id];
        return leaf.placement == kNone && (leaf.kind == LeafKind::kSphere || leaf.kind == LeafKind::kBox ||
                                           leaf.kind == LeafKind::kDisc || leaf.kind == LeafKind::kTriangle);
      });
  // The original's order of tests first, so that the result does not depend on how often this has been done.
  const auto before = [&](LeafId a, LeafId b) { return leaves[a].order < leaves[b].order; };
  std::sort(unbounded.begin(), unbounded.end(), before);
  std::vector<std::uint32_t> order;
  if (hierarchies && bounded.size() > kLoopLeaves) {
    std::vector<std::uint8_t> opacities(bounded.size());
    for (std::size_t i = 0; i < bounded.size(); ++i) opacities[i] = leaves[bounded[i]].opacity;
    group.hierarchy = std::make_shared<fas::Hierarchy>(std::move(leaf_boxes), opacities, threads, order);
  }
  std::vector<Leaf> sorted;
  sorted.reserve(group.count);
  for (const LeafId id : unbounded) sorted.push_back(leaves[id]);
  for (std::size_t i = 0; i < bounded.size(); ++i)
    sorted.push_back(leaves[bounded[order.empty() ? i : order[i]]]);
  for (const LeafId id : empty) sorted.push_back(leaves[id]);
  std::copy(sorted.begin(), sorted.end(), leaves.begin() + group.first);
}

void CompiledScene::count_bytes() {
  const auto pool = [](const auto& vector) {
    return static_cast<std::uint64_t>(vector.capacity() * sizeof(vector[0]));
  };
  counts.bytes = pool(leaves) + pool(groups) + pool(path_nodes) + pool(path_textured) + pool(path_surfaces) +
                 pool(leaf_extents) + pool(placements) + pool(csgs) + pool(instances) +
                 pool(level_transforms) + pool(bottom_up) + pool(planes) + pool(spheres) + pool(boxes) +
                 pool(discs) + pool(cylinders) + pool(cones) + pool(tori) + pool(triangles) +
                 pool(smooth_triangles) + pool(uv_triangles) + pool(polygons) + pool(blobs) +
                 pool(height_fields);
  for (const Group& group : groups) {
    if (group.hierarchy) counts.bytes += group.hierarchy->bytes();
  }
  const HeightFieldData* counted = nullptr;  // fields of one file stand next to each other at best
  for (const HeightField& field : height_fields) {
    if (&field.data() != counted) counts.bytes += field.data().altitudes.size() * sizeof(float);
    counted = &field.data();
  }
}

}  // namespace rayshade
