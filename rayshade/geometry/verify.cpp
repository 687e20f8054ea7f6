// SPDX-License-Identifier: MIT
#include "rayshade/geometry/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

namespace rayshade {
namespace {

std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

/// Of what decides the answer to a query, whoever asks.
template <class Query>
std::uint64_t hash_of(const Query& query) {
  std::uint64_t hash = query.mask;
  const Ray& ray = query.ray;
  for (const double x : {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y,
                         ray.direction.z, ray.time, query.lo, query.hi})
    hash = mixed(hash + std::bit_cast<std::uint64_t>(x) + 0x9e3779b97f4a7c15u);
  return hash;
}

template <class Query>
bool chosen(const Query& query, double share) {
  return share >= 1 || static_cast<double>(hash_of(query) >> 11) * 0x1p-53 < share;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same(const NearestAnswer& a, const NearestAnswer& b) { return same_answer(a, b); }
/// `b` is the truth: whoever says that there is nothing else in the way must be right.
bool same(const OcclusionAnswer& a, const OcclusionAnswer& b) {
  return a.occluded == b.occluded && (a.others || !b.others);
}

/// As exact as it is and as people read it.
std::string text_of(double x) { return fmt::format("{:a} ({:.17g})", x, x); }
std::string text_of(const Vec3& v) {
  return fmt::format("{:a} {:a} {:a} ({:.17g} {:.17g} {:.17g})", v.x, v.y, v.z, v.x, v.y, v.z);
}

std::string text_of(const CompiledScene& scene, const NearestAnswer& answer) {
  if (!answer.found) return "nothing";
  const Hit& hit = answer.hit;
  std::string out = fmt::format("{} of leaf {}, t {}, a {:a}, b {:a}, part {}, flag {}, rank {}",
                                name_of(scene.leaves[hit.leaf].kind), hit.leaf, text_of(hit.t()), hit.shape.a,
                                hit.shape.b, hit.shape.part, static_cast<int>(hit.flag), hit.rank);
  for (std::uint32_t i = 0; i < hit.instances.count; ++i)
    out += fmt::format("{} {}", i == 0 ? ", in instances" : "", hit.instances.leaves[i]);
  return out;
}
std::string text_of(const CompiledScene& /*scene*/, const OcclusionAnswer& answer) {
  return fmt::format("{}, {} outside of these leaves", answer.occluded ? "occluded" : "free",
                     answer.others ? "perhaps something" : "nothing");
}

std::string head_of(const NearestQuery& query) {
  return fmt::format("nearest hit of {} {}, depth {}", query.kind == RayKind::kEye ? "an" : "a",
                     name_of(query.kind), query.depth);
}
std::string head_of(const OcclusionQuery& /*query*/) { return "occlusion of a shadow ray"; }

const char* name_of(Opacity mask) {
  return mask == kOpaque ? "opaque" : mask == kTransparent ? "transparent" : "all";
}

template <class Query, class Answer>
std::string difference_text(const CompiledScene& scene, const VerifyOptions& options, const Query& query,
                            const Answer& answer, const Answer& truth, const QueryOwners* owners,
                            std::size_t number) {
  std::string out = head_of(query);
  if (owners) {
    const RayOwner owner = owners->owner(number);
    out += fmt::format(", pixel {} {}, sample {}", owner.x, owner.y, owner.sample);
  }
  if (query.light < options.light_names.size()) out += ", toward " + options.light_names[query.light];
  const Ray& ray = query.ray;
  out += fmt::format(
      "\n  origin      {}\n  direction   {}{}\n  time        {}\n  from        {}\n  to          {}\n"
      "  leaves      {}\n  answer      {}\n  brute force {}\n",
      text_of(ray.origin), text_of(ray.direction), ray.unit ? "" : ", not of unit length", text_of(ray.time),
      text_of(query.lo), text_of(query.hi), name_of(query.mask), text_of(scene, answer),
      text_of(scene, truth));
  return out;
}

}  // namespace

bool same_answer(const NearestAnswer& a, const NearestAnswer& b) {
  if (a.found != b.found) return false;
  if (!a.found) return true;
  const Hit &x = a.hit, &y = b.hit;
  if (!(same_bits(x.t(), y.t()) && same_bits(x.shape.a, y.shape.a) && same_bits(x.shape.b, y.shape.b) &&
        x.shape.part == y.shape.part && x.leaf == y.leaf && x.flag == y.flag && x.rank == y.rank &&
        x.instances.count == y.instances.count))
    return false;
  return std::equal(x.instances.leaves.begin(), x.instances.leaves.begin() + x.instances.count,
                    y.instances.leaves.begin());
}

bool is_chosen(const NearestQuery& query, double share) { return chosen(query, share); }
bool is_chosen(const OcclusionQuery& query, double share) { return chosen(query, share); }

/// What one thread needs while it verifies a span.
struct VerifyingIntersector::Slot {
  TraceScratch scratch;
  std::vector<std::uint32_t> which;
  std::pair<std::vector<NearestQuery>, std::vector<NearestAnswer>> nearest;
  std::pair<std::vector<OcclusionQuery>, std::vector<OcclusionAnswer>> occlusion;
  std::vector<std::uint32_t> denying;  ///< occlusion queries whose answer denies OcclusionAnswer::others

  auto& room(const NearestQuery* /*kind*/) { return nearest; }
  auto& room(const OcclusionQuery* /*kind*/) { return occlusion; }
};

struct VerifyingIntersector::Shared {
  std::atomic<std::uint64_t> nearest{0}, occlusion{0}, differing{0};
  std::mutex slots_mutex, report_mutex;
  std::vector<std::unique_ptr<Slot>> slots;  ///< not in use
};

/// A slot for as long as it lives.
class VerifyingIntersector::Lease {
 public:
  explicit Lease(Shared& shared) : shared_(shared) {
    const std::lock_guard lock(shared_.slots_mutex);
    if (shared_.slots.empty()) {
      slot_ = std::make_unique<Slot>();
    } else {
      slot_ = std::move(shared_.slots.back());
      shared_.slots.pop_back();
    }
  }
  ~Lease() {
    const std::lock_guard lock(shared_.slots_mutex);
    shared_.slots.push_back(std::move(slot_));
  }
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;
  Slot& operator*() const { return *slot_; }

 private:
  Shared& shared_;
  std::unique_ptr<Slot> slot_;
};

VerifyingIntersector::VerifyingIntersector(const CompiledScene& scene, std::unique_ptr<Intersector> inner,
                                           VerifyOptions options)
    : scene_(scene),
      inner_(std::move(inner)),
      oracle_(make_brute_force(scene)),
      options_(std::move(options)),
      shared_(std::make_unique<Shared>()) {}

VerifyingIntersector::~VerifyingIntersector() = default;

void VerifyingIntersector::nearest(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
                                   TraceScratch& scratch) const {
  inner_->nearest(queries, answers, scratch);
  verify<NearestQuery, NearestAnswer>(queries, answers, scratch);
}

void VerifyingIntersector::occluded(std::span<const OcclusionQuery> queries,
                                    std::span<OcclusionAnswer> answers, TraceScratch& scratch) const {
  inner_->occluded(queries, answers, scratch);
  verify<OcclusionQuery, OcclusionAnswer>(queries, answers, scratch);
}

void VerifyingIntersector::scene_changed() {
  inner_->scene_changed();
  oracle_->scene_changed();
  shared_->slots.clear();
}

VerifyCounts VerifyingIntersector::counts() const {
  return {shared_->nearest, shared_->occlusion, shared_->differing};
}

/// Occlusion of the chosen queries, and of those whose answer denies that anything outside the mask is in the
/// way, whether there is.
void VerifyingIntersector::ask_oracle(std::span<const OcclusionAnswer> answers, Slot& slot) const {
  auto& [asked, truth] = slot.occlusion;
  oracle_->occluded(asked, truth, slot.scratch);
  auto& [rest, found] = slot.nearest;
  rest.clear();
  slot.denying.clear();
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const OcclusionQuery& query = asked[k];
    const OcclusionAnswer& answer = answers[slot.which[k]];
    truth[k].others = answer.others;  // may be: nothing to check
    if (answer.others || query.mask == kAnyOpacity) continue;
    const auto others = static_cast<Opacity>(kAnyOpacity & ~query.mask);
    rest.push_back({query.ray, query.lo, query.hi, others, RayKind::kShadow, 0, query.light});
    slot.denying.push_back(static_cast<std::uint32_t>(k));
  }
  found.resize(rest.size());
  oracle_->nearest(rest, found, slot.scratch);
  for (std::size_t i = 0; i < rest.size(); ++i) truth[slot.denying[i]].others = found[i].found;
}

template <class Query, class Answer>
void VerifyingIntersector::verify(std::span<const Query> queries, std::span<const Answer> answers,
                                  const TraceScratch& scratch) const {
  constexpr bool kNearest = std::is_same_v<Query, NearestQuery>;
  const Lease lease(*shared_);
  Slot& slot = *lease;
  auto& [asked, truth] = slot.room(static_cast<const Query*>(nullptr));
  slot.which.clear();
  asked.clear();
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (!is_chosen(queries[i], options_.share)) continue;
    slot.which.push_back(static_cast<std::uint32_t>(i));
    asked.push_back(queries[i]);
  }
  if (asked.empty()) return;
  truth.resize(asked.size());
  if constexpr (kNearest)
    oracle_->nearest(asked, truth, slot.scratch);
  else
    ask_oracle(answers, slot);
  (kNearest ? shared_->nearest : shared_->occlusion) += asked.size();
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const std::uint32_t i = slot.which[k];
    if (same(answers[i], truth[k])) continue;
    if (shared_->differing++ >= VerifyOptions::kMostReported || !options_.report) continue;
    const std::string text =
        difference_text(scene_, options_, queries[i], answers[i], truth[k], scratch.owners, i);
    const std::lock_guard lock(shared_->report_mutex);
    options_.report(text);
  }
}

}  // namespace rayshade
