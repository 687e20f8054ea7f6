// SPDX-License-Identifier: MIT
// Time per call of what rendering consists of: exact tests of every shape (a mix of hits and misses, rays
// toward the shape's surroundings), noise, random numbers. Figures are for comparing kernels within one run.
#include <benchmark/benchmark.h>

#include <random>
#include <string>

#include "rayshade/geometry/intersector.h"
#include "rayshade/lang/parse.h"
#include "rayshade/sampling/random.h"
#include "rayshade/texture/noise.h"

namespace rayshade {
namespace {

struct ShapeScene {
  Scene scene;
  std::unique_ptr<CompiledScene> compiled;
};

std::unique_ptr<ShapeScene> compiled(const std::string& text) {
  MemoryProvider provider;
  provider.add("bench.ray", text);
  auto out = std::make_unique<ShapeScene>();
  ParseResult parsed = parse_scene(provider, "bench.ray", {});
  if (!parsed.ok) std::abort();
  out->scene = std::move(parsed.scene);
  out->compiled = compile_scene(out->scene, provider, {});
  return out;
}

std::vector<Ray> rays() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Ray> out(4096);
  for (Ray& ray : out) {
    const Vec3 target{1.2 * u(random), 1.2 * u(random), 1.2 * u(random)};
    ray.origin = {5 * u(random), -8, 5 * u(random)};
    ray.direction = normalize(target - ray.origin);
  }
  return out;
}

void exact_test(benchmark::State& state, const char* text) {
  const auto scene = compiled(text);
  const std::vector<Ray> all = rays();
  TraceScratch scratch;
  std::size_t i = 0;
  std::int64_t hits = 0;
  for (auto _ : state) {
    Hit hit;
    hits += exact_nearest(*scene->compiled, 0, all[i++ & 4095], 1e-5, kFar, 0, scratch, hit);
    benchmark::DoNotOptimize(hit);
  }
  state.counters["hits"] = static_cast<double>(hits) / static_cast<double>(state.iterations());
}

BENCHMARK_CAPTURE(exact_test, plane, "plane 0 0 0 0 0 1");
BENCHMARK_CAPTURE(exact_test, sphere, "sphere 1 0 0 0");
BENCHMARK_CAPTURE(exact_test, box, "box -1 -1 -1 1 1 1");
BENCHMARK_CAPTURE(exact_test, disc, "disc 1 0 0 0 0 -1 1");
BENCHMARK_CAPTURE(exact_test, cylinder, "cylinder .5 0 0 -1 0 0 1");
BENCHMARK_CAPTURE(exact_test, cone, "cone .8 0 0 -1 .1 0 0 1");
BENCHMARK_CAPTURE(exact_test, torus, "torus .8 .25 0 0 0 0 .5 1");
BENCHMARK_CAPTURE(exact_test, triangle, "triangle -1 0 -1 1 0 -1 0 0 1");
BENCHMARK_CAPTURE(exact_test, polygon, "poly -1 0 -1 1 0 -1 1 0 1 -1 0 1");
BENCHMARK_CAPTURE(exact_test, blob, "blob .4 1 1.2 -.5 0 0 .8 1 .6 .2 .3");
BENCHMARK_CAPTURE(exact_test, transformed_sphere, "sphere 1 0 0 0 rotate 1 1 1 30 scale 1 .8 1.2");
BENCHMARK_CAPTURE(exact_test, csg, "difference box -1 -1 -1 1 1 1 sphere 1.2 0 0 0 end");

void noise(benchmark::State& state) {
  double x = 0.1;
  for (auto _ : state) benchmark::DoNotOptimize(noise3({x += 0.37, 1.3 * x, -0.7 * x}));
}
BENCHMARK(noise);

void random_pair(benchmark::State& state) {
  RandomKey key;
  for (auto _ : state) {
    ++key.x;
    benchmark::DoNotOptimize(uniform2(key, dimension(0, Purpose::kPixel)));
  }
}
BENCHMARK(random_pair);

}  // namespace
}  // namespace rayshade

BENCHMARK_MAIN();
