// SPDX-License-Identifier: MIT
// The basis of the camera, computed once per frame.
#include "rayshade/sampling/camera.h"

#include <limits>

#include "rayshade/math/functions.h"

namespace rayshade {

Camera::Camera(const RenderSettings& settings)
    : eye_(settings.eye),
      half_width_(settings.width / 2.0),
      half_height_(settings.height / 2.0),
      aperture_(settings.aperture),
      start_time_(settings.start_time),
      frame_length_(settings.frame_length),
      shutter_(settings.shutter),
      side_(settings.strata()) {
  // Unit vectors before the products: models of any size keep their basis.
  const Vec3 up = normalize(settings.up);
  const auto aim = [&] {
    view_ = settings.look - eye_;
    forward_ = normalize(view_);
    right_ = normalize(cross(forward_, up));
    up_ = normalize(cross(right_, forward_));
  };
  aim();
  if (settings.stereo != Eye::kCenter) {
    const double half = settings.eye_separation / 2;
    eye_ += (settings.stereo == Eye::kLeft ? -half : half) * right_;
    aim();
  }
  const double distance = length(view_);
  focal_distance_ = settings.focal_distance.value_or(distance);
  const auto half_tangent = [](double degrees) { return fn::tan(degrees * (fn::kPi / 180) / 2); };
  step_x_ = (2 * distance * half_tangent(settings.horizontal_fov) / settings.width) * right_;
  // Rows count from the top: one row further is down.
  step_y_ = (-2 * distance * half_tangent(settings.vertical_fov) / settings.height) * up_;
  corner_ = view_ - half_width_ * step_x_ - half_height_ * step_y_;
}

std::array<double, 2> Camera::project(const Vec3& point) const {
  const Vec3 way = point - eye_;
  const double depth = dot(way, forward_);
  if (!(depth > 0)) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan};
  }
  const double scale = dot(view_, forward_) / depth;
  return {half_width_ + scale * dot(way, right_) / dot(step_x_, right_),
          half_height_ + scale * dot(way, up_) / dot(step_y_, up_)};
}

}  // namespace rayshade
