// SPDX-License-Identifier: MIT
#include "scenes/spd/databases.h"

namespace rayshade::spd {
namespace {

constexpr std::int64_t power(std::int64_t base, int exponent) {
  std::int64_t out = 1;
  for (int i = 0; i < exponent; ++i) out *= base;
  return out;
}

constexpr std::int64_t cube(std::int64_t n) { return n * n * n; }

constexpr Database kDatabases[] = {
    {"balls", "sphereflake: (9^(n+1)-1)/8 spheres and the ground", 4, 7, generate_balls,
     [](int n) { return (power(9, n + 1) - 1) / 8 + 1; }},
    {"gears", "n^3 interlocked gears of 146 polygons and the ground", 4, 40, generate_gears,
     [](int n) { return 146 * cube(n) + 1; }},
    {"mount", "fractal mountain of 2*4^n triangles and four glass spheres", 6, 11, generate_mount,
     [](int n) { return 2 * power(4, n) + 4; }},
    {"rings", "pyramid of n(n+1)(2n+1) rings of five cylinders and spheres, and a wall", 7, 80,
     generate_rings, [](int n) { return std::int64_t{10} * n * (n + 1) * (2 * n + 1) + 1; }},
    {"teapot", "teapot of 64n^2-8n smooth triangles on n^2 squares", 6, 380, generate_teapot,
     [](int n) { return std::int64_t{65} * n * n - 8 * n; }},
    {"tetra", "pyramid of 4^(n-1) tetrahedra, 4^n triangles", 6, 11, generate_tetra,
     [](int n) { return power(4, n); }},
    {"tree", "tree of 2^(n+1)-1 branches, each a cone and a sphere, and the ground", 11, 21, generate_tree,
     [](int n) { return 2 * (power(2, n + 1) - 1) + 1; }},
};

}  // namespace

std::span<const Database> databases() { return kDatabases; }

const Database* find_database(std::string_view name) {
  for (const Database& database : kDatabases)
    if (database.name == name) return &database;
  return nullptr;
}

std::vector<Light> equal_lights(std::span<const Vec3> positions) {
  std::vector<Light> lights;
  for (const Vec3& position : positions)
    lights.push_back({position, 1 / std::sqrt(static_cast<double>(positions.size()))});
  return lights;
}

void write_square(Writer& writer, double half_side, double z) {
  const double h = half_side;
  writer.polygon(std::array<Vec3, 4>{{{h, h, z}, {-h, h, z}, {-h, -h, z}, {h, -h, z}}});
}

}  // namespace rayshade::spd
