// SPDX-License-Identifier: MIT
// Eye rays (language.md 8, shading.md 1.1 and 7.6): pinhole or square lens, left, right or single eye, and
// the moment within the shutter interval. Rows count from the top.
#pragma once

#include <array>

#include "rayshade/geometry/ray.h"
#include "rayshade/math/fused.h"
#include "rayshade/scene/settings.h"

namespace rayshade {

/// Up to 64 points of the screen, in pixels from the upper left corner of the field of view, and where rays
/// through them go.
struct ScreenPoints {
  static constexpr std::size_t kMost = 64;

  std::size_t count = 0;
  alignas(64) double u[kMost] = {}, v[kMost] = {};
  alignas(64) double to[3][kMost];  ///< unit directions, by axis

  Vec3 direction(std::size_t i) const { return {to[0][i], to[1][i], to[2][i]}; }
};

/// Immutable; any number of threads may share one.
class Camera {
 public:
  /// `settings` has passed resolve_settings: view and up are not parallel.
  explicit Camera(const RenderSettings& settings);

  /// The ray through the screen point (u, v), in pixels from the upper left corner of the field of view: from
  /// the eye, of unit length, time not set.
  Ray ray(double u, double v) const {
    Ray out;
    ray(u, v, out);
    return out;
  }
  /// The same, made in place; the time is left as it is.
  void ray(double u, double v, Ray& out) const {
    out.origin = eye_;
    // In fused arithmetic, as the reference pictures were made: where a texture changes at a plane of the
    // scene, the pattern of rounding shows (textures.md D20).
    fused::unit_of_sum(corner_, u, step_x_, v, step_y_, out.direction);
    out.unit = true;
  }

  /// The directions of the rays through many points, bit by bit those of ray().
  void aim(ScreenPoints& points) const;

  /// True where eye rays start on a lens instead of at a point.
  bool has_lens() const { return aperture_ > 0; }

  /// The ray of sample number `s` through the screen point (u, v) and the point of the lens cell of `s` that
  /// `xi` and `zeta` in [0, 1) choose. Points at the focal distance from the eye are sharp.
  Ray lens_ray(double u, double v, int s, double xi, double zeta) const {
    const int column = s % side_, row = s / side_;
    const double p = -1 + (column + xi) * 2 / side_;
    const double q = -1 + (row + zeta) * 2 / side_;
    const Vec3 shift = aperture_ * (p * right_ + q * up_);
    return {eye_ + shift, normalize(focal_distance_ * ray(u, v).direction - shift)};
  }

  /// Where the rays of the lens start.
  Bounds3 lens_bounds() const {
    const Vec3 reach = aperture_ * (abs(right_) + abs(up_));
    return {eye_ - reach, eye_ + reach};
  }

  /// The time of sample number `s` in a frame: the start of its slice of the shutter interval, moved by `xi`
  /// in [0, 1) of a slice. Always the start of the frame without a shutter.
  double time(int frame, int s, double xi) const {
    const double start = start_time_ + frame * frame_length_;
    return shutter_ > 0 ? start + shutter_ / (side_ * side_) * (s + xi) : start;
  }

  const Vec3& eye() const { return eye_; }          ///< after the stereo shift
  const Vec3& forward() const { return forward_; }  ///< unit
  const Vec3& right() const { return right_; }      ///< unit
  const Vec3& up() const { return up_; }            ///< unit, on the screen
  double focal_distance() const { return focal_distance_; }
  /// From the eye to the point looked at.
  double look_distance() const { return length(view_); }

  /// Where a point in front of the eye is seen on the screen: the (u, v) of the ray that meets it. Not finite
  /// for points beside or behind the eye plane.
  std::array<double, 2> project(const Vec3& point) const;

 private:
  Vec3 eye_, view_;  // view_: eye to look point
  Vec3 corner_;      // eye to the screen point (0, 0)
  Vec3 forward_, right_, up_;
  Vec3 step_x_, step_y_;  // one pixel to the right, one pixel down, at the look point
  double half_width_, half_height_;
  double aperture_, focal_distance_;
  double start_time_, frame_length_, shutter_;
  int side_;
};

}  // namespace rayshade
