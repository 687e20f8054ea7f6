// SPDX-License-Identifier: MIT
// The databases as input for POV-Ray 3.7. Its space is left-handed; a negative `right` vector makes it ours.
//
// POV-Ray takes light that is transmitted away from diffuse light, the databases add it: the diffuse weight
// is divided by what POV-Ray will leave of it.
#include <fmt/format.h>

#include "scenes/spd/writer.h"

namespace rayshade::spd {
namespace {

std::string text(const Vec3& v) { return fmt::format("<{},{},{}>", number(v.x), number(v.y), number(v.z)); }
std::string text(const Color& c) {
  return fmt::format("rgb <{},{},{}>", number(c.r), number(c.g), number(c.b));
}

class PovWriter final : public Writer {
 public:
  explicit PovWriter(std::ostream& out) : out_(out) {}

  void header(std::string_view title, const View& view) override {
    out_ << "// " << title << "\n#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 5 }\n";
    out_ << "camera {\n  location " << text(view.eye) << "\n  sky " << text(view.up)
         << "\n  up y\n  right -x\n  angle " << number(view.degrees) << "\n  look_at " << text(view.look)
         << "\n}\n";
    out_ << "background { color " << text(view.background) << " }\n";
    for (const Light& light : view.lights)
      out_ << "light_source { " << text(light.position) << ", color "
           << text(Color{1, 1, 1} * light.intensity) << " }\n";
  }

  void surface(const Surface& s) override {
    ++surfaces_;
    const double opacity = 1 - s.transmission;
    out_ << fmt::format(
        "#declare S{} = material {{\n  texture {{\n    pigment {{ color rgbt <{},{},{},{}> }}\n", surfaces_,
        number(s.color.r), number(s.color.g), number(s.color.b), number(s.transmission));
    out_ << fmt::format("    finish {{ ambient {} diffuse {}", number(s.ambient),
                        number(opacity > 0 ? s.diffuse / opacity : 0));
    if (s.highlight > 0)
      out_ << fmt::format(" phong {} phong_size {}", number(s.highlight), number(s.exponent));
    if (s.reflection > 0) out_ << fmt::format(" reflection {}", number(s.reflection));
    out_ << " }\n  }\n";
    if (s.transmission > 0) out_ << fmt::format("  interior {{ ior {} }}\n", number(s.index));
    out_ << "}\n";
  }

  void sphere(double radius, const Vec3& center) override {
    out_ << "sphere { " << text(center) << ", " << number(radius);
    material();
  }

  void cone(double base_radius, const Vec3& base, double apex_radius, const Vec3& apex) override {
    if (base_radius == apex_radius)
      out_ << "cylinder { " << text(base) << ", " << text(apex) << ", " << number(base_radius) << " open";
    else
      out_ << "cone { " << text(base) << ", " << number(base_radius) << ", " << text(apex) << ", "
           << number(apex_radius) << " open";
    material();
  }

  // POV-Ray wants the outline closed by its first point.
  void polygon(std::span<const Vec3> points) override {
    out_ << "polygon { " << points.size() + 1;
    for (const Vec3& p : points) out_ << ", " << text(p);
    out_ << ", " << text(points.front());
    material();
  }

  void triangle(const std::array<Vertex, 3>& corners) override {
    out_ << "smooth_triangle { ";
    for (int i = 0; i < 3; ++i)
      out_ << (i > 0 ? ", " : "") << text(corners[i].point) << ", " << text(corners[i].normal);
    material();
  }

 private:
  void material() { out_ << " material { S" << surfaces_ << " } }\n"; }

  std::ostream& out_;
  int surfaces_ = 0;
};

}  // namespace

std::unique_ptr<Writer> make_pov_writer(std::ostream& out) { return std::make_unique<PovWriter>(out); }

}  // namespace rayshade::spd
