// SPDX-License-Identifier: MIT
// What a database is told to: a view, lights, surfaces and four kinds of objects. One implementation per file
// format.
//
// Order of calls: header() once, then any number of surface() and objects, then finish(). Objects take the
// surface named last. Coordinates are right-handed with z up in the formats that know an up direction.
#pragma once

#include <array>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rayshade/math/vec.h"

namespace rayshade::spd {

struct Light {
  Vec3 position;
  double intensity = 1;  ///< the same for red, green and blue
};

/// Where the picture is taken from. The databases are square pictures with a field of view of 45 degrees.
struct View {
  Color background{0.078, 0.361, 0.753};
  Vec3 eye, look, up{0, 0, 1};
  double degrees = 45;
  int resolution = 512;
  double hither = 1;  ///< near plane, for formats that have one; no ray tracer needs it
  std::vector<Light> lights;
};

/// Reflection as the databases describe it: a base colour with weights.
struct Surface {
  Color color{1, 1, 1};
  double ambient = 0;     ///< weight of the colour in ambient light
  double diffuse = 0;     ///< weight of the colour in diffuse light
  double highlight = 0;   ///< white Phong highlight
  double exponent = 0;    ///< Phong exponent of the highlight
  double reflection = 0;  ///< mirrored light
  double transmission = 0;
  double index = 1;
};

struct Vertex {
  Vec3 point, normal;
};

class Writer {
 public:
  virtual ~Writer() = default;

  virtual void header(std::string_view title, const View& view) = 0;
  virtual void surface(const Surface& surface) = 0;
  virtual void sphere(double radius, const Vec3& center) = 0;
  /// A truncated cone without end caps; equal radii make a cylinder.
  virtual void cone(double base_radius, const Vec3& base, double apex_radius, const Vec3& apex) = 0;
  /// A flat polygon, concave allowed; counter-clockwise seen from outside.
  virtual void polygon(std::span<const Vec3> points) = 0;
  /// A triangle with interpolated normals.
  virtual void triangle(const std::array<Vertex, 3>& corners) = 0;
  virtual void finish() {}
};

/// The writer for `format` ("rayshade", "nff" or "pov") on `out`, which must outlive it; null for any other
/// name.
std::unique_ptr<Writer> make_writer(std::string_view format, std::ostream& out);

std::unique_ptr<Writer> make_rayshade_writer(std::ostream& out);
std::unique_ptr<Writer> make_nff_writer(std::ostream& out);
std::unique_ptr<Writer> make_pov_writer(std::ostream& out);

/// The shortest decimal that reads back as `value` to ten significant digits; -0 becomes 0.
std::string number(double value);

}  // namespace rayshade::spd
