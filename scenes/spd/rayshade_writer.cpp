// SPDX-License-Identifier: MIT
// The databases in the Rayshade 4.0 language: one grid with all objects, surfaces defined inside it as they
// come.
#include <fmt/format.h>

#include "scenes/spd/writer.h"

namespace rayshade::spd {
namespace {

// Voxels along each side of the grid; a hint that costs nothing where the renderer has an index of its own.
constexpr int kVoxels = 22;

std::string text(const Vec3& v) { return number(v.x) + ' ' + number(v.y) + ' ' + number(v.z); }

class RayshadeWriter final : public Writer {
 public:
  explicit RayshadeWriter(std::ostream& out) : out_(out) {}

  void header(std::string_view title, const View& view) override {
    out_ << "/* " << title << " */\n";
    out_ << fmt::format("screen {0} {0}\nsample 1 nojitter\n", view.resolution);
    out_ << fmt::format("background {} {} {}\n", view.background.r, view.background.g, view.background.b);
    out_ << "eyep " << text(view.eye) << "\nlookp " << text(view.look) << "\nup " << text(view.up) << '\n';
    out_ << "fov " << number(view.degrees) << ' ' << number(view.degrees) << '\n';
    for (const Light& light : view.lights)
      out_ << "light " << number(light.intensity) << " point " << text(light.position) << '\n';
    out_ << fmt::format("grid {0} {0} {0}\n", kVoxels);
  }

  void surface(const Surface& s) override {
    out_ << "surface s" << ++surfaces_;
    color("ambient", s.color * s.ambient);
    color("diffuse", s.color * s.diffuse);
    if (s.highlight > 0) {
      color("specular", Color{1, 1, 1} * s.highlight);
      out_ << " specpow " << number(s.exponent);
    }
    if (s.reflection > 0) out_ << " reflect " << number(s.reflection);
    if (s.transmission > 0) out_ << " transp " << number(s.transmission) << " index " << number(s.index);
    out_ << "\napplysurf s" << surfaces_ << '\n';
  }

  void sphere(double radius, const Vec3& center) override {
    out_ << "sphere " << number(radius) << ' ' << text(center) << '\n';
  }

  void cone(double base_radius, const Vec3& base, double apex_radius, const Vec3& apex) override {
    out_ << "cone " << number(base_radius) << ' ' << text(base) << ' ' << number(apex_radius) << ' '
         << text(apex) << '\n';
  }

  void polygon(std::span<const Vec3> points) override {
    out_ << "polygon";
    for (const Vec3& p : points) out_ << ' ' << text(p);
    out_ << '\n';
  }

  void triangle(const std::array<Vertex, 3>& corners) override {
    out_ << "triangle";
    for (const Vertex& c : corners) out_ << ' ' << text(c.point) << ' ' << text(c.normal);
    out_ << '\n';
  }

  void finish() override { out_ << "end\n"; }

 private:
  void color(std::string_view keyword, const Color& c) {
    out_ << ' ' << keyword << ' ' << number(c.r) << ' ' << number(c.g) << ' ' << number(c.b);
  }

  std::ostream& out_;
  int surfaces_ = 0;
};

}  // namespace

std::unique_ptr<Writer> make_rayshade_writer(std::ostream& out) {
  return std::make_unique<RayshadeWriter>(out);
}

}  // namespace rayshade::spd
