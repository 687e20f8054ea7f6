// SPDX-License-Identifier: MIT
// The databases in the Neutral File Format (E. Haines): v, b, l, f, s, c, p and pp records. The format has no
// ambient light, and one number serves as highlight and as reflection.
#include <algorithm>

#include "scenes/spd/writer.h"

namespace rayshade::spd {
namespace {

std::string text(const Vec3& v) { return number(v.x) + ' ' + number(v.y) + ' ' + number(v.z); }
std::string text(const Color& c) { return number(c.r) + ' ' + number(c.g) + ' ' + number(c.b); }

class NffWriter final : public Writer {
 public:
  explicit NffWriter(std::ostream& out) : out_(out) {}

  void header(std::string_view title, const View& view) override {
    out_ << "# " << title << "\nv\nfrom " << text(view.eye) << "\nat " << text(view.look) << "\nup "
         << text(view.up) << "\nangle " << number(view.degrees) << "\nhither " << number(view.hither)
         << "\nresolution " << view.resolution << ' ' << view.resolution << "\nb " << text(view.background)
         << '\n';
    for (const Light& light : view.lights)
      out_ << "l " << text(light.position) << ' ' << text(Color{1, 1, 1} * light.intensity) << '\n';
  }

  void surface(const Surface& s) override {
    out_ << "f " << text(s.color) << ' ' << number(s.diffuse) << ' '
         << number(std::max(s.highlight, s.reflection)) << ' ' << number(s.exponent) << ' '
         << number(s.transmission) << ' ' << number(s.transmission > 0 ? s.index : 0) << '\n';
  }

  void sphere(double radius, const Vec3& center) override {
    out_ << "s " << text(center) << ' ' << number(radius) << '\n';
  }

  void cone(double base_radius, const Vec3& base, double apex_radius, const Vec3& apex) override {
    out_ << "c\n"
         << text(base) << ' ' << number(base_radius) << '\n'
         << text(apex) << ' ' << number(apex_radius) << '\n';
  }

  void polygon(std::span<const Vec3> points) override {
    out_ << "p " << points.size() << '\n';
    for (const Vec3& p : points) out_ << text(p) << '\n';
  }

  void triangle(const std::array<Vertex, 3>& corners) override {
    out_ << "pp 3\n";
    for (const Vertex& c : corners) out_ << text(c.point) << ' ' << text(c.normal) << '\n';
  }

 private:
  std::ostream& out_;
};

}  // namespace

std::unique_ptr<Writer> make_nff_writer(std::ostream& out) { return std::make_unique<NffWriter>(out); }

}  // namespace rayshade::spd
