// SPDX-License-Identifier: MIT
#include "bench/triangulate.h"

#include <cmath>
#include <numeric>

namespace rayshade::bench {

std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<fas::Point>& corners) {
  // Newell's normal gives the plane; two axes of it the coordinates.
  double n[3] = {};
  const std::size_t count = corners.size();
  for (std::size_t i = 0; i < count; ++i) {
    const fas::Point &p = corners[i], &q = corners[(i + 1) % count];
    n[0] += (p[1] - q[1]) * (p[2] + q[2]);
    n[1] += (p[2] - q[2]) * (p[0] + q[0]);
    n[2] += (p[0] - q[0]) * (p[1] + q[1]);
  }
  const std::size_t drop = std::fabs(n[0]) > std::fabs(n[1]) && std::fabs(n[0]) > std::fabs(n[2]) ? 0
                           : std::fabs(n[1]) > std::fabs(n[2])                                    ? 1
                                                                                                  : 2;
  const std::size_t a = (drop + 1) % 3, b = (drop + 2) % 3;
  const double turn = n[drop] < 0 ? -1 : 1;
  const auto area = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    const fas::Point &p = corners[i], &q = corners[j], &r = corners[k];
    return turn * ((q[a] - p[a]) * (r[b] - p[b]) - (q[b] - p[b]) * (r[a] - p[a]));
  };
  std::vector<std::uint32_t> left(count);
  std::iota(left.begin(), left.end(), 0u);
  std::vector<std::array<std::uint32_t, 3>> out;
  while (left.size() > 3) {
    bool cut = false;
    for (std::size_t i = 0; i < left.size() && !cut; ++i) {
      const std::uint32_t p = left[(i + left.size() - 1) % left.size()], q = left[i],
                          r = left[(i + 1) % left.size()];
      if (!(area(p, q, r) > 0)) continue;
      bool ear = true;
      for (const std::uint32_t s : left) {
        if (corners[s] == corners[p] || corners[s] == corners[q] || corners[s] == corners[r]) continue;
        if (area(p, q, s) >= 0 && area(q, r, s) >= 0 && area(r, p, s) >= 0) {
          ear = false;
          break;
        }
      }
      if (!ear) continue;
      out.push_back({p, q, r});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
      cut = true;
    }
    if (!cut) left.erase(left.begin());  // only corners in one line are left
  }
  if (left.size() == 3) out.push_back({left[0], left[1], left[2]});
  return out;
}

}  // namespace rayshade::bench
