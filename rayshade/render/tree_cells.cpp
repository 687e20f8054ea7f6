// SPDX-License-Identifier: MIT
#include "rayshade/render/tree_cells.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace rayshade {
namespace {

using Corner = std::array<double, 2>;

/// The pyramid of directions that a window shows, by the inward normals of its four sides.
class Pyramid {
 public:
  Pyramid(const Camera& camera, const RenderSettings& settings) {
    const double x0 = settings.min_x, y0 = settings.min_y;
    const double x1 = x0 + settings.window_width(), y1 = y0 + settings.window_height();
    const Vec3 corners[4] = {camera.ray(x0, y0).direction, camera.ray(x1, y0).direction,
                             camera.ray(x1, y1).direction, camera.ray(x0, y1).direction};
    const Vec3 inside = corners[0] + corners[1] + corners[2] + corners[3];
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 normal = normalize(cross(corners[i], corners[(i + 1) % 4]));
      sides_[i] = dot(normal, inside) < 0 ? -normal : normal;
    }
  }
  /// Cuts off what is outside of a convex cone, given by the directions of its edges (J. Sutherland, G.
  /// Hodgman, "Reentrant polygon clipping", CACM 17(1), 1974). What is left is in front of the eye.
  void clip(std::vector<Vec3>& edges) const {
    std::vector<Vec3> out;
    for (const Vec3& side : sides_) {
      out.clear();
      for (std::size_t i = 0; i < edges.size(); ++i) {
        const Vec3 &a = edges[i], &b = edges[(i + 1) % edges.size()];
        const double da = dot(side, a), db = dot(side, b);
        if (da >= 0) out.push_back(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) out.push_back(a + (da / (da - db)) * (b - a));
      }
      edges.swap(out);
    }
  }

 private:
  std::array<Vec3, 4> sides_;
};

double area_of(const std::vector<Corner>& corners) {
  double twice = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner &a = corners[i], &b = corners[(i + 1) % corners.size()];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return std::fabs(twice) / 2;
}

}  // namespace

double area_of(const TreeCell& cell) { return area_of(cell.corners); }

TreeCells tree_cells(const fas::HyperTree& tree, const Camera& camera, const RenderSettings& settings) {
  const Pyramid pyramid(camera, settings);
  std::array<std::unique_ptr<fas::Plane>, 6> planes;
  TreeCells out;
  std::vector<Vec3> edges;
  tree.each_leaf([&](int face, double u, double v, double size, const fas::Leaf& leaf) {
    auto& plane = planes[static_cast<std::size_t>(face)];
    if (!plane) plane = std::make_unique<fas::Plane>(tree.view(), face);
    // The root square may reach beyond the face; rays of this face do not.
    const double u0 = std::max(u, -1.0), u1 = std::min(u + size, 1.0);
    const double v0 = std::max(v, -1.0), v1 = std::min(v + size, 1.0);
    TreeCell cell;
    edges.clear();
    if (u0 < u1 && v0 < v1) {
      for (const Corner& corner : {Corner{u0, v0}, Corner{u1, v0}, Corner{u1, v1}, Corner{u0, v1}}) {
        const fas::Point d = plane->direction(corner[0], corner[1]);
        edges.push_back({d[0], d[1], d[2]});
      }
      pyramid.clip(edges);
    }
    for (const Vec3& edge : edges) {
      const std::array<double, 2> seen = camera.project(camera.eye() + edge);
      cell.corners.push_back({std::clamp(seen[0] - settings.min_x, 0.0, double(settings.window_width())),
                              std::clamp(seen[1] - settings.min_y, 0.0, double(settings.window_height()))});
    }
    if (!(area_of(cell.corners) > 0)) {
      ++out.outside;
      return;
    }
    cell.candidates = leaf.count;
    cell.depth = leaf.depth;
    out.visible.push_back(std::move(cell));
  });
  return out;
}

}  // namespace rayshade
