// SPDX-License-Identifier: MIT
// The seven Standard Procedural Databases: E. Haines, "A Proposal for Standard Graphics Environments", IEEE
// Computer Graphics and Applications 7(11), 1987, and the later package of that name. Each grows with a size
// factor.
//
// The geometry follows the descriptions there; constants that they leave open were measured on published data
// of the default sizes. At other sizes than these the databases agree in counts, and in shape up to such
// constants.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "scenes/spd/writer.h"

namespace rayshade::spd {

struct Database {
  std::string_view name;
  std::string_view what;  ///< one line for the user
  int default_size;
  int largest_size;  ///< about ten million objects; the smallest is 1
  void (*generate)(int size, Writer& writer);
  std::int64_t (*count)(int size);  ///< how many objects generate() makes, ground included
};

std::span<const Database> databases();
/// Null if there is none of that name.
const Database* find_database(std::string_view name);

void generate_balls(int size, Writer& writer);
void generate_gears(int size, Writer& writer);
void generate_mount(int size, Writer& writer);
void generate_rings(int size, Writer& writer);
void generate_teapot(int size, Writer& writer);
void generate_tetra(int size, Writer& writer);
void generate_tree(int size, Writer& writer);

/// Lights of equal strength whose intensities add up, in squares, to 1: the rule of the databases.
std::vector<Light> equal_lights(std::span<const Vec3> positions);
/// A rectangle through four corners, counter-clockwise from above: the ground under most databases.
void write_square(Writer& writer, double half_side, double z);

}  // namespace rayshade::spd
