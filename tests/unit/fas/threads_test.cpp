// SPDX-License-Identifier: MIT
// Several threads grow the same trees: each gets the answers of a loop over all primitives, whoever makes
// which node, and also when memory runs out midway. Small enough for the thread sanitizer.
#include <gtest/gtest.h>

#include <thread>

#include "fas/batch.h"
#include "tests/unit/fas/scene.h"

namespace fas {
namespace {

using test::Dice;
using Place = HyperTree::Place;

constexpr std::uint32_t kNobody = 0xffffffffu;

struct Answer {
  std::uint32_t primitive = kNobody;
  double t = 1e30;
  bool occluded = false;
};

struct Ray {
  double direction[3];  ///< from the eye
  double start[3];      ///< of a ray toward the light
};

class Shared {
 public:
  Shared(std::uint64_t seed, int triangles, int rays) : scene_(make(seed, triangles)) {
    Dice dice(seed + 1);
    for (int i = 0; i < rays; ++i) {
      Ray ray;
      const Point target = dice.in_box(1.2), start = dice.in_box(2);
      for (std::size_t k = 0; k < 3; ++k) {
        ray.direction[k] = target[k] - kEye[k];
        ray.start[k] = start[k];
      }
      rays_.push_back(ray);
      Answer answer;
      for (std::uint32_t id = 0; id < scene_.count(); ++id) {
        nearest(ray, id, answer);
        answer.occluded = answer.occluded || stops(ray, id);
      }
      truth_.push_back(answer);
    }
  }

  /// Threads answer all rays in orders of their own; returns how many answers came from trees, after
  /// comparing all with the truth.
  std::uint64_t run(std::size_t budget, Split split, int threads, int frames) {
    Pool pool(budget);
    Tuner tuner;
    const View eye = make_view(View::Kind::kPoint, kEye, scene_.bounds(), 1);
    const View light = make_view(View::Kind::kPoint, kLight, scene_.bounds(), 1);
    HyperTree from(eye, scene_, pool, tuner, 0, split), toward(light, scene_, pool, tuner, 1, split);
    std::uint64_t in_trees = 0;
    for (int frame = 0; frame < frames; ++frame) {
      std::vector<std::vector<Answer>> answers(static_cast<std::size_t>(threads));
      std::vector<TreeCounts> counts(static_cast<std::size_t>(threads));
      std::vector<std::thread> running;
      for (std::size_t k = 0; k < answers.size(); ++k) {
        running.emplace_back([&, k] {
          ThreadState state(pool);
          answers[k].resize(rays_.size());
          const std::size_t step = kSteps[(k + static_cast<std::size_t>(frame)) % 4];
          if (k % 2 == 0) {
            for (std::size_t i = 0; i < rays_.size(); ++i)
              single(from, toward, state, (i * step + 31 * k) % rays_.size(), answers[k]);
          } else {
            in_groups(from, toward, state, step, answers[k]);
          }
          for (const TreeCache& cache : state.caches) counts[k].add(cache.counts);
        });
      }
      for (std::thread& thread : running) thread.join();
      for (std::size_t k = 0; k < answers.size(); ++k) {
        for (std::size_t i = 0; i < rays_.size(); ++i) {
          EXPECT_EQ(answers[k][i].primitive, truth_[i].primitive) << "thread " << k << ", ray " << i;
          EXPECT_EQ(answers[k][i].t, truth_[i].t) << "thread " << k << ", ray " << i;
          EXPECT_EQ(answers[k][i].occluded, truth_[i].occluded) << "thread " << k << ", ray " << i;
          if (testing::Test::HasFailure()) return 0;
        }
        EXPECT_EQ(counts[k].rays + counts[k].elsewhere, 2 * rays_.size());
        in_trees += counts[k].rays;
      }
      EXPECT_LE(pool.used(), budget);
      EXPECT_LE(pool.held(), budget);
      exhausted_ += pool.exhausted();
      // The next frame starts with nothing.
      from.clear();
      toward.clear();
      pool.reset();
    }
    return in_trees;
  }

  int exhausted() const { return exhausted_; }
  std::size_t hits() const {
    std::size_t count = 0;
    for (const Answer& answer : truth_) count += answer.primitive != kNobody;
    return count;
  }

 private:
  static constexpr Point kEye{0.1, 3, 0.2}, kLight{0.3, 0.2, 0.1};
  static constexpr std::size_t kSteps[4] = {1, 7, 11, 13};

  static std::vector<Geometry> make(std::uint64_t seed, int triangles) {
    Dice dice(seed);
    std::vector<Geometry> out;
    for (int i = 0; i < triangles; ++i) {
      Geometry g;
      g.form = Geometry::Form::kPolygon;
      g.opaque = dice.below(2) != 0;
      const Point at = dice.in_box(1);
      const double size = dice.size(-1.5, dice.below(20) ? -0.5 : 0.3);
      g.points = {at, test::along(at, dice.direction(), size), test::along(at, dice.direction(), size)};
      test::set_box(g);
      out.push_back(g);
    }
    return out;
  }

  bool nearest(const Ray& ray, std::uint32_t id, Answer& answer) const {
    const double t = test::triangle_hit(scene_[id], kEye.data(), ray.direction);
    if (!(t > 0) || t > answer.t || (t == answer.t && id >= answer.primitive)) return false;
    answer.t = t;
    answer.primitive = id;
    return true;
  }
  bool stops(const Ray& ray, std::uint32_t id) const {
    const double d[3] = {kLight[0] - ray.start[0], kLight[1] - ray.start[1], kLight[2] - ray.start[2]};
    const double t = test::triangle_hit(scene_[id], ray.start, d);
    return t > 0 && t < 1;
  }
  void ask_all_nearest(std::size_t i, Answer& answer) const {
    for (std::uint32_t id = 0; id < scene_.count(); ++id) nearest(rays_[i], id, answer);
  }
  void ask_all_occluded(std::size_t i, Answer& answer) const {
    for (std::uint32_t id = 0; id < scene_.count() && !answer.occluded; ++id)
      answer.occluded = stops(rays_[i], id);
  }

  void single(HyperTree& from, HyperTree& toward, ThreadState& state, std::size_t i,
              std::vector<Answer>& out) const {
    Answer& answer = out[i];
    answer = {};
    const Ray& ray = rays_[i];
    if (nearest_from_apex(
            from, state, ray.direction, [&] { return answer.t; },
            [&](std::uint32_t id) { return nearest(ray, id, answer); }) == Place::kElsewhere)
      ask_all_nearest(i, answer);
    if (occluded_toward(
            toward, state, ray.start, [&](std::uint32_t id) { return stops(ray, id); }, answer.occluded) ==
        Place::kElsewhere)
      ask_all_occluded(i, answer);
  }

  void in_groups(HyperTree& from, HyperTree& toward, ThreadState& state, std::size_t step,
                 std::vector<Answer>& out) const {
    LeafGroups groups;
    constexpr std::uint32_t kSpan = 500;
    std::vector<std::uint8_t> u(kSpan), v(kSpan);
    std::vector<std::size_t> rays(kSpan);
    for (std::size_t first = 0; first < rays_.size(); first += kSpan) {
      const auto count = static_cast<std::uint32_t>(std::min<std::size_t>(kSpan, rays_.size() - first));
      for (std::uint32_t i = 0; i < count; ++i) rays[i] = (first + i) * step % rays_.size();
      for (HyperTree* tree : {&from, &toward}) {
        groups.clear();
        for (std::uint32_t i = 0; i < count; ++i) {
          const Ray& ray = rays_[rays[i]];
          const HyperTree::Query query =
              tree == &from ? tree->from_apex(ray.direction) : tree->toward(ray.start);
          const Leaf* leaf = nullptr;
          TreeCache& cache = state.cache(tree->number());
          const Place place = tree->find(query, state, cache, leaf, u[i], v[i]);
          if (place == Place::kLeaf) {
            groups.add(*tree, leaf, query, i, count);
            continue;
          }
          ++(place == Place::kNothing ? cache.counts.rays : cache.counts.elsewhere);
          if (place != Place::kElsewhere) continue;
          if (tree == &from)
            ask_all_nearest(rays[i], out[rays[i]]);
          else
            ask_all_occluded(rays[i], out[rays[i]]);
        }
        for (const LeafGroups::Group& group : groups.groups())
          answer_group(group, tree == &from, state, groups, u, v, rays, out);
      }
    }
  }

  void answer_group(const LeafGroups::Group& group, bool eye, ThreadState& state, const LeafGroups& groups,
                    const std::vector<std::uint8_t>& u, const std::vector<std::uint8_t>& v,
                    const std::vector<std::size_t>& rays, std::vector<Answer>& out) const {
    std::uint32_t next = group.first;
    for (std::uint32_t left = group.count; left > 0;) {
      GroupProbe probe;
      std::size_t at[GroupProbe::kMost];
      double depths[GroupProbe::kMost];
      for (; left > 0 && probe.count < GroupProbe::kMost; --left, next = groups.next(next)) {
        const auto k = static_cast<std::size_t>(probe.count++);
        at[k] = rays[next];
        probe.u[k] = u[next];
        probe.v[k] = v[next];
        const HyperTree::Query query = group.tree->toward(rays_[at[k]].start);
        depths[k] = eye ? std::fabs(rays_[at[k]].direction[group.any.face >> 1]) : query.depth;
      }
      if (eye) {
        nearest_in_group(
            *group.tree, state, *group.leaf, group.any, probe,
            [&](std::uint32_t id, std::uint64_t mask) {
              std::uint64_t better = 0;
              for (; mask != 0; mask &= mask - 1) {
                const std::size_t k = static_cast<std::size_t>(std::countr_zero(mask));
                if (nearest(rays_[at[k]], id, out[at[k]])) better |= std::uint64_t{1} << k;
              }
              return better;
            },
            [&](int k) { return out[at[k]].t * depths[k]; });
        continue;
      }
      const std::uint64_t stopped = occluded_in_group(*group.tree, state, *group.leaf, group.any, probe,
                                                      depths, [&](std::uint32_t id, std::uint64_t mask) {
                                                        std::uint64_t hit = 0;
                                                        for (; mask != 0; mask &= mask - 1) {
                                                          const int k = std::countr_zero(mask);
                                                          if (stops(rays_[at[k]], id))
                                                            hit |= std::uint64_t{1} << k;
                                                        }
                                                        return hit;
                                                      });
      for (int k = 0; k < probe.count; ++k) out[at[k]].occluded = (stopped >> k & 1) != 0;
    }
  }

  test::Scene scene_;
  std::vector<Ray> rays_;
  std::vector<Answer> truth_;
  int exhausted_ = 0;
};

constexpr std::size_t kPlenty = std::size_t{256} << 20;

TEST(Threads, GrowTheSameTrees) {
  for (const Split split : {Split::kAdaptive, Split::kAlways}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      Shared shared(seed, 400, 997);
      EXPECT_GT(shared.hits(), 200u);
      const std::uint64_t in_trees = shared.run(kPlenty, split, 4, 2);
      ASSERT_FALSE(HasFailure()) << "seed " << seed;
      EXPECT_GT(in_trees, 2u * 4 * 997) << "most rays are answered by the trees";
      EXPECT_EQ(shared.exhausted(), 0);
    }
  }
}

/// From none at all to enough: somewhere in between it runs out in the middle.
TEST(Threads, MayRunOutOfMemory) {
  int exhausted = 0;
  std::uint64_t in_trees = 0;
  for (std::size_t chunks = 0; chunks <= 12; ++chunks) {
    Shared shared(100 + chunks, 1'500, 499);
    const std::uint64_t now = shared.run(chunks * Pool::kChunk, Split::kAlways, 4, 2);
    ASSERT_FALSE(HasFailure()) << chunks << " chunks";
    if (chunks == 0) {
      EXPECT_EQ(now, 0u);
    }
    in_trees += now;
    exhausted += shared.exhausted();
  }
  EXPECT_GT(in_trees, 10'000u);
  EXPECT_GE(exhausted, 4);  // how many depends on when leaves are split, and so on the clock
}

/// One thread gets what many get, and what it got before.
TEST(Threads, OneIsAsGoodAsMany) {
  Shared shared(50, 500, 997);
  for (const int threads : {1, 2, 8}) {
    shared.run(kPlenty, Split::kAdaptive, threads, 3);
    ASSERT_FALSE(HasFailure()) << threads;
  }
}

}  // namespace
}  // namespace fas
