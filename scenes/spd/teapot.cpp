// SPDX-License-Identifier: MIT
// M. Newell's teapot (1975): 32 bicubic Bezier patches, each cut into 2 * size^2 triangles with true normals,
// on a chequered ground.
//
// Twenty-four patches are quarters of four bodies of revolution and are made from their profiles; handle and
// spout have two pairs of patches each, one half of each pair given, the other its mirror image.
#include "scenes/spd/databases.h"

namespace rayshade::spd {
namespace {

// points[row][column]; u runs along a row, v from row to row.
struct Patch {
  Vec3 points[4][4];
};

struct ProfilePoint {
  double radius, z;
  double arc = 0.56;  // the handles of a quarter circle, as a part of the radius
};
using Profile = std::array<ProfilePoint, 4>;

constexpr Profile kRim = {{{1.4, 2.4}, {1.3375, 2.53125}, {1.4375, 2.53125}, {1.5, 2.4}}};
constexpr Profile kUpperBody = {{{1.5, 2.4}, {1.75, 1.875}, {2, 1.35}, {2, 0.9}}};
constexpr Profile kLowerBody = {{{2, 0.9}, {2, 0.45}, {1.5, 0.225}, {1.5, 0.15}}};
constexpr Profile kKnob = {{{0, 3.15}, {0.8, 3.15, 0.5625}, {0, 2.85}, {0.2, 2.7}}};
constexpr Profile kLid = {{{0.2, 2.7}, {0.4, 2.55}, {1.3, 2.55}, {1.3, 2.4}}};
constexpr Profile kBottom = {{{0, 0}, {1.425, 0}, {1.5, 0.075}, {1.5, 0.15}}};

// Half patches, y <= 0: the first two columns; the third and fourth are the other end of the tube's half
// circle.
struct TubeRow {
  double inner_x, inner_z, outer_x, outer_z, half_width;
};
using Tube = std::array<TubeRow, 4>;

constexpr Tube kUpperHandle = {{{-1.6, 2.025, -1.5, 2.25, 0.3},
                                {-2.3, 2.025, -2.5, 2.25, 0.3},
                                {-2.7, 2.025, -3.0, 2.25, 0.3},
                                {-2.7, 1.8, -3.0, 1.8, 0.3}}};
constexpr Tube kLowerHandle = {{{-2.7, 1.8, -3.0, 1.8, 0.3},
                                {-2.7, 1.575, -3.0, 1.35, 0.3},
                                {-2.5, 1.125, -2.65, 0.9375, 0.3},
                                {-2.0, 0.9, -1.9, 0.6, 0.3}}};
constexpr Tube kLowerSpout = {{{1.7, 1.425, 1.7, 0.6, 0.66},
                               {2.6, 1.425, 3.1, 0.825, 0.66},
                               {2.3, 2.1, 2.4, 2.025, 0.25},
                               {2.7, 2.4, 3.3, 2.4, 0.25}}};
constexpr Tube kUpperSpout = {{{2.7, 2.4, 3.3, 2.4, 0.25},
                               {2.8, 2.475, 3.525, 2.49375, 0.25},
                               {2.9, 2.475, 3.45, 2.5125, 0.15},
                               {2.8, 2.4, 3.2, 2.4, 0.15}}};

// A quarter turn about z, `quarters` times `sense` (1: from x to y).
Vec3 turned(Vec3 p, int quarters, int sense) {
  for (int i = 0; i < quarters; ++i) p = sense > 0 ? Vec3{-p.y, p.x, p.z} : Vec3{p.y, -p.x, p.z};
  return p;
}

Patch revolved(const Profile& profile, int quarter, int sense) {
  Patch patch;
  for (int row = 0; row < 4; ++row) {
    const auto& [r, z, arc] = profile[row];
    const double a = sense * arc * r;
    const Vec3 points[4] = {{r, 0, z}, {r, a, z}, {arc * r, sense * r, z}, {0, sense * r, z}};
    for (int i = 0; i < 4; ++i) patch.points[row][i] = turned(points[i], quarter, sense);
  }
  return patch;
}

// The half with y <= 0, or its mirror image, run through backwards so that both face outward.
Patch tube_half(const Tube& tube, bool mirrored) {
  Patch patch;
  for (int row = 0; row < 4; ++row) {
    const TubeRow& t = tube[row];
    const double y = mirrored ? t.half_width : -t.half_width;
    const Vec3 points[4] = {{t.inner_x, 0, t.inner_z},
                            {t.inner_x, y, t.inner_z},
                            {t.outer_x, y, t.outer_z},
                            {t.outer_x, 0, t.outer_z}};
    for (int i = 0; i < 4; ++i) patch.points[row][mirrored ? 3 - i : i] = points[i];
  }
  return patch;
}

using Weights = std::array<double, 4>;

Weights bernstein(double t) {
  const double s = 1 - t;
  return {s * s * s, 3 * t * s * s, 3 * t * t * s, t * t * t};
}

Weights bernstein_derivative(double t) {
  const double s = 1 - t;
  return {-3 * s * s, 3 * s * s - 6 * t * s, 6 * t * s - 3 * t * t, 3 * t * t};
}

Vec3 blend(const Patch& patch, const Weights& along_row, const Weights& across_rows) {
  Vec3 sum;
  for (int row = 0; row < 4; ++row)
    for (int i = 0; i < 4; ++i) sum += across_rows[row] * along_row[i] * patch.points[row][i];
  return sum;
}

// Where a row has shrunk to a point its tangent along u vanishes; the tangent's derivative along v has its
// direction.
Vertex evaluate(const Patch& patch, double u, double v) {
  const Weights bu = bernstein(u), bv = bernstein(v), du = bernstein_derivative(u),
                dv = bernstein_derivative(v);
  Vec3 tangent = blend(patch, du, bv);
  if (length(tangent) < 1e-9) tangent = blend(patch, du, dv);
  return {blend(patch, bu, bv), normalize(cross(tangent, blend(patch, bu, dv)))};
}

void write_patch(Writer& writer, const Patch& patch, int size) {
  const auto vertex = [&](int i, int j) {
    return evaluate(patch, static_cast<double>(i) / size, static_cast<double>(j) / size);
  };
  const bool pole = patch.points[0][0] == patch.points[0][3];
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const Vertex a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      if (!(pole && j == 0)) writer.triangle({a, b, c});
      writer.triangle({c, d, a});
    }
}

// Every second square of size x size, those with an even or an odd sum of numbers.
void write_squares(Writer& writer, int size, int parity) {
  const auto at = [size](int i) { return 8.0 * i / size - 4; };
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j)
      if ((i + j) % 2 == parity)
        writer.polygon(std::array<Vec3, 4>{
            {{at(i), at(j), 0}, {at(i + 1), at(j), 0}, {at(i + 1), at(j + 1), 0}, {at(i), at(j + 1), 0}}});
}

}  // namespace

void generate_teapot(int size, Writer& writer) {
  View view;
  view.eye = {4.86, 7.2, 5.4};
  view.lights = equal_lights(std::array<Vec3, 2>{{{-3.1, 9.8, 12.1}, {11.3, 5.1, 8.8}}});
  writer.header("teapot", view);
  Surface square{.diffuse = 0.5, .highlight = 0.5, .exponent = 4.81884, .reflection = 0.5};
  writer.surface(square);
  write_squares(writer, size, 1);
  square.diffuse = 0.25;
  writer.surface(square);
  write_squares(writer, size, 0);

  writer.surface(
      {.color = {1, 0.5, 0.1}, .diffuse = 0.75, .highlight = 0.25, .exponent = 3.0827, .reflection = 0.25});
  const auto body = [&](const Profile& profile, int sense) {
    for (int quarter = 0; quarter < 4; ++quarter)
      write_patch(writer, revolved(profile, quarter, sense), size);
  };
  const auto tube = [&](const Tube& half) {
    write_patch(writer, tube_half(half, false), size);
    write_patch(writer, tube_half(half, true), size);
  };
  body(kRim, -1);
  body(kUpperBody, -1);
  body(kLowerBody, -1);
  tube(kUpperHandle);
  tube(kLowerHandle);
  tube(kLowerSpout);
  tube(kUpperSpout);
  body(kKnob, -1);
  body(kLid, -1);
  body(kBottom, 1);
}

}  // namespace rayshade::spd
