// SPDX-License-Identifier: MIT
// The height field (objects.md 5): n x n altitudes over the unit square, two triangles per cell; triangles
// with an unset corner do not exist.
//
// A ray is taken into grid coordinates, where vertex (i, j) has x = i and y = j exactly, and descends a
// pyramid of altitude ranges from front to back. Triangles are tested with edge functions of vertices
// projected along the ray; an edge has the same value, bit for bit and with exact sign, in both of its
// triangles, so that nothing leaks between neighbours. The hit distance is clamped into the ray's stay in the
// cell, so that the order of the descent cannot change which triangle is nearest.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "rayshade/geometry/ray.h"
#include "rayshade/image/height_field_file.h"
#include "rayshade/math/bounds.h"

namespace rayshade {

class HeightField {
 public:
  /// Builds the pyramid. Throws std::invalid_argument where there are fewer than 2 x 2 points or not as many
  /// as `size` says, and std::length_error where the triangles cannot be numbered with 32 bits (size >
  /// 46341).
  explicit HeightField(std::shared_ptr<const HeightFieldData> data);

  /// The nearest t >= lo with t <= hi. hit.part: 2 * (row * (n - 1) + column), plus 1 for the upper right
  /// triangle; hit.a, hit.b: coordinates within the cell, 0 to 1.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const;
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  /// From above.
  bool entering(const Ray& ray, double lo, const ShapeHit& hit) const;
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal, const ShapeHit& hit) const;
  /// Without any triangle: the unit square at altitude 0.
  Bounds3 bounds() const { return bounds_; }

  const HeightFieldData& data() const { return *data_; }

 private:
  struct Range {
    float lo, hi;  ///< lo > hi: nothing there
  };
  /// Ranges of the squares of 2^k x 2^k cells; k starts at 1. The four squares of the next level's square are
  /// neighbours in memory; those beyond the edge of the field are empty.
  struct Level {
    std::uint32_t pairs;  ///< squares of the next level per row
    std::vector<std::array<Range, 4>> ranges;

    Range& at(std::uint32_t i, std::uint32_t j) {
      return ranges[std::size_t{j / 2} * pairs + i / 2][2 * (j % 2) + i % 2];
    }
  };
  /// A triangle's plane in grid coordinates: its altitude at one corner and its slopes per cell.
  struct Facet {
    double corner_x, corner_y, corner_z, slope_x, slope_y;
  };
  struct Walk;

  float altitude(std::uint32_t i, std::uint32_t j) const {
    return data_->altitudes[static_cast<std::size_t>(j) * (cells_ + 1) + i];
  }
  Range cell_range(std::uint32_t i, std::uint32_t j) const;
  Facet facet(std::uint32_t part) const;
  /// The facet's normal in primitive space, upward, not normalised: n_z = 1.
  Vec3 steepness(const Facet& facet) const;
  template <int Axis>
  void descend(Walk& walk) const;
  template <int Axis>
  void test_cell(Walk& walk, std::uint32_t i, std::uint32_t j, double near, double far) const;

  std::shared_ptr<const HeightFieldData> data_;
  std::uint32_t cells_;  ///< per side
  std::vector<Level> levels_;
  Bounds3 bounds_;
};

}  // namespace rayshade
