// SPDX-License-Identifier: MIT
// A cube of gears, `size` to a side, each layer a square of wheels that mesh with their neighbours. A gear is
// two outlines of 144 points and 144 flanks; one gear of five is transparent.
#include <algorithm>

#include "rayshade/math/functions.h"
#include "scenes/spd/databases.h"

namespace rayshade::spd {
namespace {

constexpr int kTeeth = 36;
constexpr int kPoints = 4 * kTeeth;
// Radii in units of which 19 is half the distance between axes; a wheel of 20 would just fit.
constexpr double kPitch = 19, kTip = 19.9, kRoot = 18, kRoom = 20;
// Degrees from a tooth's middle to the ends of its tip and of its foot.
constexpr double kTipHalf = 1.9, kFootHalf = 3;
constexpr double kStep = 360.0 / kTeeth;
constexpr double kThickness = 0.4;  // of the distance between layers

using Outline = std::array<Vec3, kPoints>;

// Neighbouring wheels are turned against each other by half a tooth.
Outline gear_outline(const Vec3& center, double unit, bool half_turned) {
  const double corners[4][2] = {
      {kTip, -kTipHalf}, {kTip, kTipHalf}, {kRoot, kFootHalf}, {kRoot, kStep - kFootHalf}};
  Outline out;
  for (int tooth = 0; tooth < kTeeth; ++tooth) {
    for (int i = 0; i < 4; ++i) {
      const double angle = (tooth * kStep + corners[i][1] + (half_turned ? kStep / 2 : 0)) * (fn::kPi / 180);
      out[4 * tooth + i] = center + unit * corners[i][0] * Vec3{fn::cos(angle), fn::sin(angle), 0};
    }
  }
  return out;
}

// Colours and the choice of transparent gears run through small residues of the position, so that neighbours
// differ.
Surface gear_surface(int x, int y, int z) {
  const auto level = [](int residue) { return residue % 7 + 0.07; };
  Color color{level(x + 3 * y + 5 * z + 5), level(3 * x + 2 * y + 6 * z + 3),
              level(4 * x + 2 * y + 6 * z + 2)};
  color *= 1 / std::max({color.r, color.g, color.b});
  if ((x + 3 * y + 4 * z) % 5 == 0)
    return {.color = color, .diffuse = 0.2, .transmission = 0.8, .index = 1.1};
  return {.color = color, .diffuse = 1};
}

void write_gear(Writer& writer, const Outline& top, double thickness) {
  writer.polygon(top);
  const Vec3 down{0, 0, -thickness};
  for (int i = 0; i < kPoints; ++i) {
    const Vec3& a = top[i];
    const Vec3& b = top[(i + 1) % kPoints];
    writer.polygon(std::array<Vec3, 4>{a, a + down, b + down, b});
  }
  Outline bottom;
  for (int i = 0; i < kPoints; ++i) bottom[i] = top[(kPoints + 1 - i) % kPoints] + down;
  writer.polygon(bottom);
}

}  // namespace

void generate_gears(int size, Writer& writer) {
  View view;
  view.eye = {-1.1, -2.1, 2.6};
  view.lights = equal_lights(
      std::array<Vec3, 5>{{{2, 4, 4}, {-2, 4, 3}, {2, -2.5, 2.5}, {-1, -4, 2}, {-1.111, -2.121, 2.626}}});
  writer.header("gears", view);
  writer.surface(
      {.color = {1, 0.85, 0.7}, .diffuse = 0.3, .highlight = 0.3, .exponent = 3.0827, .reflection = 0.6});
  write_square(writer, 2, 0);

  const double unit = 1 / (kPitch * (size - 1) + kRoom);
  const double layer = 1.0 / size;
  for (int z = 0; z < size; ++z)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const Vec3 center{unit * kPitch * (2 * x - size + 1), unit * kPitch * (2 * y - size + 1),
                          1 - z * layer};
        writer.surface(gear_surface(x, y, z));
        write_gear(writer, gear_outline(center, unit, (x + y + z) % 2 != 0), kThickness * layer);
      }
}

}  // namespace rayshade::spd
