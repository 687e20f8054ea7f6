// SPDX-License-Identifier: MIT
// Verification finds every lie about a query that it has chosen, and nothing else.
#include "rayshade/geometry/verify.h"

#include <gtest/gtest.h>

#include "tests/unit/geometry/lying_intersector.h"
#include "tests/unit/geometry/random_scene.h"

namespace rayshade {
namespace {

using test::LyingIntersector;
using test::RandomScene;

struct Queries {
  std::vector<NearestQuery> nearest;
  std::vector<OcclusionQuery> occlusion;
  std::vector<NearestAnswer> nearest_answers;
  std::vector<OcclusionAnswer> occlusion_answers;

  Queries(RandomScene& random, std::size_t count)
      : nearest(count), occlusion(count), nearest_answers(count), occlusion_answers(count) {
    for (NearestQuery& query : nearest) query.ray = random.ray(4), query.lo = kEpsilon;
    for (OcclusionQuery& query : occlusion) query.ray = random.ray(4), query.lo = kEpsilon, query.light = 0;
  }
  void ask(const Intersector& intersector, TraceScratch& scratch) {
    intersector.nearest(nearest, nearest_answers, scratch);
    intersector.occluded(occlusion, occlusion_answers, scratch);
  }
};

struct Checked {
  VerifyCounts counts;
  std::uint64_t lies = 0;
  std::vector<std::string> texts;
};

Checked check(std::uint64_t every_nearest, std::uint64_t every_occlusion, double share) {
  RandomScene random(77);
  random.fill(40, 4);
  const auto scene = random.b.compile();
  Checked out;
  auto liar = std::make_unique<LyingIntersector>(make_hierarchy(*scene), every_nearest, every_occlusion);
  const LyingIntersector& lies = *liar;
  const VerifyingIntersector verifier(
      *scene, std::move(liar),
      {share, {"light 1 (point)"}, [&](const std::string& text) { out.texts.push_back(text); }});
  Queries queries(random, 1000);
  TraceScratch scratch;
  queries.ask(verifier, scratch);
  out.counts = verifier.counts();
  out.lies = lies.lies();
  return out;
}

TEST(Verify, AnHonestIntersectorIsNotBlamed) {
  const Checked all = check(0, 0, 1);
  EXPECT_EQ(all.counts.nearest, 1000u);
  EXPECT_EQ(all.counts.occlusion, 1000u);
  EXPECT_EQ(all.counts.differing, 0u);
  EXPECT_TRUE(all.texts.empty());
}

TEST(Verify, EveryLieAboutNearestHitsIsCaught) {
  const Checked checked = check(7, 0, 1);
  EXPECT_EQ(checked.lies, 1000u / 7);
  EXPECT_EQ(checked.counts.differing, checked.lies);
  ASSERT_EQ(checked.texts.size(), VerifyOptions::kMostReported);
  for (const std::string& text : checked.texts) {
    EXPECT_NE(text.find("nearest hit"), std::string::npos) << text;
    EXPECT_NE(text.find("0x1."), std::string::npos) << text;
    EXPECT_NE(text.find("brute force"), std::string::npos) << text;
  }
}

TEST(Verify, EveryLieAboutOcclusionIsCaught) {
  const Checked checked = check(0, 100, 1);
  EXPECT_EQ(checked.lies, 10u);
  EXPECT_EQ(checked.counts.differing, checked.lies);
  ASSERT_EQ(checked.texts.size(), 10u);
  EXPECT_NE(checked.texts[0].find("occlusion of a shadow ray, toward light 1 (point)"), std::string::npos)
      << checked.texts[0];
}

/// Denies that anything outside of the mask is in the way.
class Denier final : public Intersector {
 public:
  explicit Denier(const CompiledScene& scene) : inner_(make_hierarchy(scene)) {}
  void nearest(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
               TraceScratch& scratch) const override {
    inner_->nearest(queries, answers, scratch);
  }
  void occluded(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                TraceScratch& scratch) const override {
    inner_->occluded(queries, answers, scratch);
    for (OcclusionAnswer& answer : answers) answer.others = false;
  }

 private:
  std::unique_ptr<Intersector> inner_;
};

TEST(Verify, WhoeverDeniesOtherObjectsMustBeRight) {
  RandomScene random(79);
  random.fill(40, 4);
  const auto scene = random.b.compile();
  Queries queries(random, 1000);
  for (OcclusionQuery& query : queries.occlusion) query.mask = kOpaque;
  const auto oracle = make_brute_force(*scene);
  std::uint64_t wrong = 0;
  for (const OcclusionQuery& query : queries.occlusion) {
    TraceScratch scratch;
    wrong += test::nearest(*oracle, query.ray, scratch, query.lo, query.hi, kTransparent).found;
  }
  TraceScratch scratch;
  std::string last;
  const VerifyingIntersector denied(*scene, std::make_unique<Denier>(*scene),
                                    {1, {}, [&](const std::string& text) { last = text; }});
  queries.ask(denied, scratch);
  EXPECT_GT(wrong, 10u);
  EXPECT_EQ(denied.counts().differing, wrong);
  EXPECT_NE(last.find("nothing outside of these leaves"), std::string::npos) << last;
  TraceScratch honest_scratch;
  const VerifyingIntersector honest(*scene, make_hierarchy(*scene), {});
  queries.ask(honest, honest_scratch);
  EXPECT_EQ(honest.counts().differing, 0u);
}

TEST(Verify, AShareIsThatShareOfTheQueriesWhateverTheSpans) {
  const Checked tenth = check(1, 1, .1);
  EXPECT_NEAR(static_cast<double>(tenth.counts.nearest), 100, 35);
  EXPECT_NEAR(static_cast<double>(tenth.counts.occlusion), 100, 35);
  EXPECT_EQ(tenth.counts.differing, tenth.counts.rays());

  RandomScene random(5);
  Queries queries(random, 500);
  for (const NearestQuery& query : queries.nearest) {
    EXPECT_TRUE(is_chosen(query, 1));
    EXPECT_FALSE(is_chosen(query, 0));
    EXPECT_EQ(is_chosen(query, .5), is_chosen(NearestQuery(query), .5));
    EXPECT_TRUE(is_chosen(query, .5) || !is_chosen(query, .25));
    NearestQuery for_another = query;
    for_another.kind = RayKind::kReflected;
    for_another.depth = 3;
    EXPECT_EQ(is_chosen(query, .5), is_chosen(for_another, .5)) << "who asks is no part of a query";
  }
}

TEST(Verify, CountsAndCachesOfTheRunAreNotDisturbed) {
  RandomScene random(78);
  random.fill(40, 4);
  const auto scene = random.b.compile();
  Queries queries(random, 300);
  TraceScratch plain, checked;
  queries.ask(*make_hierarchy(*scene), plain);
  const std::vector<NearestAnswer> answers = queries.nearest_answers;
  queries.ask(VerifyingIntersector(*scene, make_hierarchy(*scene), {}), checked);
  EXPECT_EQ(checked.counts.tests, plain.counts.tests);
  EXPECT_EQ(checked.counts.hits, plain.counts.hits);
  EXPECT_EQ(checked.counts.bounds_tests, plain.counts.bounds_tests);
  EXPECT_FALSE(checked.brute_force);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    EXPECT_TRUE(same_answer(answers[i], queries.nearest_answers[i]));
    EXPECT_EQ(answers[i].tests, queries.nearest_answers[i].tests);
  }
}

TEST(Verify, SameAnswersAreTheSameToTheLastBit) {
  NearestAnswer a;
  a.found = true;
  a.hit.shape = {1, .25, .5, 2};
  a.hit.leaf = 3;
  a.hit.rank = 4;
  a.hit.instances.count = 1;
  a.hit.instances.leaves[0] = 9;
  EXPECT_TRUE(same_answer(a, a));
  const auto differs = [&](auto&& change) {
    NearestAnswer b = a;
    change(b);
    return !same_answer(a, b) && !same_answer(b, a);
  };
  EXPECT_TRUE(differs([](NearestAnswer& b) { b.found = false; }));
  EXPECT_TRUE(differs([](NearestAnswer& b) { b.hit.shape.t = std::nextafter(1, 2); }));
  EXPECT_TRUE(differs([](NearestAnswer& b) { b.hit.shape.a = -.25; }));
  EXPECT_TRUE(differs([](NearestAnswer& b) { b.hit.shape.b = 0; }));
  EXPECT_TRUE(differs([](NearestAnswer& b) { b.hit.shape.part = 1; }));
  EXPECT_TRUE(differs([](NearestAnswer& b) { b.hit.leaf = 4; }));
  EXPECT_TRUE(differs([](NearestAnswer& b) { b.hit.rank = 5; }));
  EXPECT_TRUE(differs([](NearestAnswer& b) { b.hit.flag = EnterFlag::kEntering; }));
  EXPECT_TRUE(differs([](NearestAnswer& b) { b.hit.instances.count = 0; }));
  EXPECT_TRUE(differs([](NearestAnswer& b) { b.hit.instances.leaves[0] = 8; }));
}

}  // namespace
}  // namespace rayshade
