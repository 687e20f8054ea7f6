// SPDX-License-Identifier: MIT
// A square part of a face of a flat tree, and what areas on the face have to do with it.
#pragma once

#include <cmath>
#include <limits>

#include "fas/areas.h"

namespace fas {

/// A square part of the root square.
struct Part {
  double x, y, size;

  bool meets(const Area& a) const {
    if (!(a.x0 <= x + size && a.x1 >= x && a.y0 <= y + size && a.y1 >= y)) return false;
    for (int k = 0; k < a.cuts; ++k) {
      const double half = 0.5 * size;
      const double middle = a.cut[k][0] * (x + half) + a.cut[k][1] * (y + half) + a.cut[k][2];
      const double reach = (std::fabs(a.cut[k][0]) + std::fabs(a.cut[k][1])) * half;
      if (middle + reach < -0x1p-40 * (std::fabs(middle) + reach)) return false;
    }
    return true;
  }
  /// Whether an area is as large as this part, so that splitting it will not get rid of it.
  bool within(const Area& a) const {
    if (!(a.x0 <= x && a.x1 >= x + size && a.y0 <= y && a.y1 >= y + size)) return false;
    return within_cuts(a, nullptr);
  }
  bool covered_by(const Area& a) const { return a.covers && within_cuts(a, a.inside); }

 private:
  bool within_cuts(const Area& a, const double* inside) const {
    for (int k = 0; k < a.cuts; ++k) {
      const double half = 0.5 * size;
      const double middle = a.cut[k][0] * (x + half) + a.cut[k][1] * (y + half) + a.cut[k][2];
      const double reach = (std::fabs(a.cut[k][0]) + std::fabs(a.cut[k][1])) * half;
      if (!(middle - reach > (inside ? inside[k] : 0))) return false;
    }
    return true;
  }
};

/// What is behind the nearest cover of a part; infinite where nothing covers it.
struct Truncation {
  double limit = std::numeric_limits<double>::infinity();
  void see(const Part& part, const Area& area) {
    if (area.z1 < limit && part.covered_by(area)) limit = area.z1;
  }
  bool drops(double z0) const { return z0 > limit; }
};

}  // namespace fas
