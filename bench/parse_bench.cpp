// SPDX-License-Identifier: MIT
// Parsing speed on a mix of primitives, surfaces and transforms: parse_bench [MEGABYTES] [FILE]. With FILE it
// only writes the scene there.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <random>

#include "rayshade/lang/parse.h"

namespace {

std::string mixed_scene(std::size_t bytes) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-10, 10);
  const auto n = [&] { return fmt::format("{:.6g}", u(random)); };
  const auto v = [&] { return n() + " " + n() + " " + n(); };
  std::string out = "surface s0 ambient .1 .1 .1 diffuse .5 .5 .5\n";
  int surfaces = 1;
  while (out.size() < bytes) {
    if (random() % 50 == 0) {
      out += fmt::format(
          "surface s{} ambient .1 .1 .1 diffuse {} .5 .5 specular .2 .2 .2 specpow 20 reflect .1\n", surfaces,
          std::abs(u(random)) / 10);
      ++surfaces;
    }
    const std::string s = fmt::format("s{}", random() % static_cast<unsigned>(surfaces));
    switch (random() % 8) {
      case 0:
        out += fmt::format("sphere {} {} {}\n", s, 0.01 + std::abs(u(random)), v());
        break;
      case 1:
        out += fmt::format("triangle {} {} {} {}\n", s, v(), v(), v());
        break;
      case 2:
        out += fmt::format("triangle {} {} {} {} {} {} {}\n", s, v(), v(), v(), v(), v(), v());
        break;
      case 3:
        out += fmt::format("poly {} {} {} {} {}\n", s, v(), v(), v(), v());
        break;
      case 4:
        out += fmt::format("cylinder {} .5 {} {}\n", s, v(), v());
        break;
      case 5:
        out += fmt::format("cone {} .5 {} .25 {}\n", s, v(), v());
        break;
      case 6:
        out += fmt::format("box {} {} {} rotate 0 0 1 {} translate {}\n", s, v(), v(), n(), v());
        break;
      default:
        out += fmt::format("sphere {} 1 {} scale 2 3 4 translate {}\n", s, v(), v());
        break;
    }
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t megabytes = argc > 1 ? std::stoul(argv[1]) : 50;
  rayshade::MemoryProvider provider;
  std::string text = mixed_scene(megabytes << 20);
  const double size = static_cast<double>(text.size());
  if (argc > 2) {
    std::FILE* file = std::fopen(argv[2], "w");
    if (!file) return 1;
    std::fwrite(text.data(), 1, text.size(), file);
    return std::fclose(file) == 0 ? 0 : 1;
  }
  provider.add("mixed.ray", std::move(text));
  double best = 1e9;
  std::size_t nodes = 0;
  for (int i = 0; i < 3; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const rayshade::ParseResult result = rayshade::parse_scene(provider, "mixed.ray", {});
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    nodes = result.scene.nodes.size();
    if (!result.ok) return 1;
  }
  fmt::print("parsed {:.1f} MB, {} objects, in {:.2f} s: {:.1f} MB/s\n", size / 1e6, nodes, best,
             size / 1e6 / best);
  return 0;
}
