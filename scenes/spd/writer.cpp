// SPDX-License-Identifier: MIT
#include "scenes/spd/writer.h"

#include <fmt/format.h>

namespace rayshade::spd {

std::unique_ptr<Writer> make_writer(std::string_view format, std::ostream& out) {
  if (format == "rayshade") return make_rayshade_writer(out);
  if (format == "nff") return make_nff_writer(out);
  if (format == "pov") return make_pov_writer(out);
  return nullptr;
}

// Coordinates are of the order of 1: what is far below a float's last digit there is the rounding of a zero.
std::string number(double value) { return fmt::format("{:.10g}", std::fabs(value) < 1e-14 ? 0.0 : value); }

}  // namespace rayshade::spd
