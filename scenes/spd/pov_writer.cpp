// SPDX-License-Identifier: MIT
// The databases as input for POV-Ray 3.7, written so that one sample per pixel gives the picture of the
// Rayshade scene. What differs between the two programs and is evened out here:
//
// - Rayshade's only sample of a pixel lies one pixel up and left of the centre that POV-Ray samples. The
// camera
//   is given by its vectors, the direction leaning that much; they also turn POV-Ray's left-handed space into
//   ours.
// - POV-Ray takes light that is transmitted away from diffuse light, the databases add it: the diffuse weight
// is
//   divided by what POV-Ray will leave of it.
// - Rayshade's specular colour, our highlight, also scales what is mirrored.
// - POV-Ray enters and leaves media by object: the faces of a transparent solid are one union with one
// interior.
// - Rayshade counts secondary rays and bounds their depth by 5, POV-Ray counts the eye's ray, too.
#include <fmt/format.h>

#include "rayshade/math/functions.h"
#include "scenes/spd/writer.h"

namespace rayshade::spd {
namespace {

// Rayshade's defaults: the depth of secondary rays, and the contribution below which none is traced.
constexpr int kSecondaryDepth = 5;
constexpr double kCutoff = 0.002;

std::string text(const Vec3& v) { return fmt::format("<{},{},{}>", number(v.x), number(v.y), number(v.z)); }
std::string text(const Color& c) {
  return fmt::format("rgb <{},{},{}>", number(c.r), number(c.g), number(c.b));
}

class PovWriter final : public Writer {
 public:
  explicit PovWriter(std::ostream& out) : out_(out) {}

  void header(std::string_view title, const View& view) override {
    out_ << "// " << title << "\n#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level "
         << kSecondaryDepth + 1 << " adc_bailout " << number(kCutoff) << " }\n";
    const Vec3 forward = normalize(view.look - view.eye);
    const double side = 2 * fn::tan(view.degrees * (fn::kPi / 180) / 2);
    const Vec3 right = side * normalize(cross(forward, view.up));
    const Vec3 up = side * normalize(cross(right, forward));
    const Vec3 direction = forward + (up - right) / view.resolution;
    out_ << "camera {\n  location " << text(view.eye) << "\n  right " << text(right) << "\n  up " << text(up)
         << "\n  direction " << text(direction) << "\n}\n";
    out_ << "background { color " << text(view.background) << " }\n";
    for (const Light& light : view.lights)
      out_ << "light_source { " << text(light.position) << ", color "
           << text(Color{1, 1, 1} * light.intensity) << " }\n";
  }

  void surface(const Surface& s) override {
    end_union();
    ++surfaces_;
    transparent_ = s.transmission > 0;
    const double opacity = 1 - s.transmission;
    out_ << fmt::format(
        "#declare S{} = material {{\n  texture {{\n    pigment {{ color rgbt <{},{},{},{}> }}\n", surfaces_,
        number(s.color.r), number(s.color.g), number(s.color.b), number(s.transmission));
    out_ << fmt::format("    finish {{ ambient {} diffuse {}", number(s.ambient),
                        number(opacity > 0 ? s.diffuse / opacity : 0));
    if (s.highlight > 0)
      out_ << fmt::format(" phong {} phong_size {}", number(s.highlight), number(s.exponent));
    if (s.reflection * s.highlight > 0)
      out_ << fmt::format(" reflection {}", number(s.reflection * s.highlight));
    out_ << " }\n  }\n";
    if (s.transmission > 0) out_ << fmt::format("  interior {{ ior {} }}\n", number(s.index));
    out_ << "}\n";
  }

  void sphere(double radius, const Vec3& center) override {
    begin() << "sphere { " << text(center) << ", " << number(radius);
    end_object();
  }

  void cone(double base_radius, const Vec3& base, double apex_radius, const Vec3& apex) override {
    if (base_radius == apex_radius)
      begin() << "cylinder { " << text(base) << ", " << text(apex) << ", " << number(base_radius) << " open";
    else
      begin() << "cone { " << text(base) << ", " << number(base_radius) << ", " << text(apex) << ", "
              << number(apex_radius) << " open";
    end_object();
  }

  // POV-Ray wants the outline closed by its first point.
  void polygon(std::span<const Vec3> points) override {
    begin() << "polygon { " << points.size() + 1;
    for (const Vec3& p : points) out_ << ", " << text(p);
    out_ << ", " << text(points.front());
    end_object();
  }

  void triangle(const std::array<Vertex, 3>& corners) override {
    begin() << "smooth_triangle { ";
    for (int i = 0; i < 3; ++i)
      out_ << (i > 0 ? ", " : "") << text(corners[i].point) << ", " << text(corners[i].normal);
    end_object();
  }

  void finish() override { end_union(); }

 private:
  std::ostream& begin() {
    if (transparent_ && !in_union_) out_ << "union {\n";
    in_union_ = transparent_;
    return out_;
  }

  // Closes an object, with its material unless its union will have it.
  void end_object() {
    if (!in_union_) material();
    out_ << " }\n";
  }

  void end_union() {
    if (!in_union_) return;
    material();
    out_ << " }\n";
    in_union_ = false;
  }

  void material() { out_ << " material { S" << surfaces_ << " }"; }

  std::ostream& out_;
  int surfaces_ = 0;
  bool transparent_ = false, in_union_ = false;
};

}  // namespace

std::unique_ptr<Writer> make_pov_writer(std::ostream& out) { return std::make_unique<PovWriter>(out); }

}  // namespace rayshade::spd
