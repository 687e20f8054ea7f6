// SPDX-License-Identifier: MIT
#include "rayshade/cli/class_report.h"

#include <fmt/format.h>

namespace rayshade {
namespace {

using Method = IntersectorReport::Method;
using Rays = ClassReport::Rays;
using Tree = ClassReport::Tree;

/// So many lights have a line of their own: area lights are many.
constexpr int kMostLights = 16;

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

const char* name_of(Tree tree) {
  return tree == Tree::kFlat ? "flat" : tree == Tree::kDeep ? "deep" : "none";
}

const char* name_of(Method method) {
  switch (method) {
    case Method::kUnknown:
      break;
    case Method::kBruteForce:
      return "brute force";
    case Method::kPacks:
      return "packs";
    case Method::kHierarchy:
      return "hierarchy";
    case Method::kTrees:
      return "trees";
  }
  return "unknown";
}

const char* sentence_of(Method method) {
  switch (method) {
    case Method::kUnknown:
      break;
    case Method::kBruteForce:
      return "testing every object";
    case Method::kPacks:
      return "testing every object of few, in packs of rays";
    case Method::kHierarchy:
      return "the hierarchy of boxes alone";
    case Method::kTrees:
      return "trees of classes of rays";
  }
  return "unknown";
}

std::string line(const std::string& name, const ClassReport& c) {
  const fas::TreeCounts& t = c.in_tree;
  std::string out =
      fmt::format("  {:<20} {:<4} {:>10} {:>6.1f} {:>6.1f}", name, name_of(c.tree), c.queries(),
                  100 * ratio(c.left_by_place(), c.queries()), 100 * ratio(c.left_by_choice(), c.queries()));
  // Of rays in trees and, where there were none, of those through the hierarchy.
  out += t.rays > 0
             ? fmt::format(" {:>6.2f} {:>6.1f}", ratio(t.tests, t.rays), 100 * ratio(t.cached_leaf, t.rays))
             : fmt::format(" {:>6} {:>6}", "-", "-");
  out += c.in_hierarchy.rays > 0 ? fmt::format(" {:>6.2f}", ratio(c.in_hierarchy.tests, c.in_hierarchy.rays))
                                 : fmt::format(" {:>6}", "-");
  if (c.tree != Tree::kNoTree) {
    out += fmt::format(" {:>8} {:>8} {:>6.1f} {:>7} {:>7.2f} {:>7.1f}", t.nodes, t.leaves,
                       ratio(t.candidates, t.leaves), t.splits, static_cast<double>(t.bytes) / 1e6,
                       static_cast<double>(t.nanoseconds) / 1e6);
  }
  return out + "\n";
}

}  // namespace

std::string class_name(const ClassReport& report, const RenderStatistics& statistics) {
  switch (report.rays) {
    case Rays::kEye:
      return "eye";
    case Rays::kReflected:
      return "reflected";
    case Rays::kTransmitted:
      return "transmitted";
    case Rays::kLight:
      return statistics.light_names.at(report.light);
    case Rays::kOther:
      break;
  }
  return "other shadow rays";
}

std::string classes_text(const RenderStatistics& statistics) {
  const IntersectorReport& report = statistics.intersector;
  std::string out = fmt::format("{:<36}{}\n", "Objects were found by:", sentence_of(report.method));
  if (report.method != Method::kTrees) return out;
  out += fmt::format(
      "  {:<20} {:<4} {:>10} {:>6} {:>6} {:>6} {:>6} {:>6} {:>8} {:>8} {:>6} {:>7} {:>7} {:>7}\n", "", "", "",
      "%left", "%left", "tests/", "% in", "tests/", "", "", "cand./", "", "", "ms to");
  out +=
      fmt::format("  {:<20} {:<4} {:>10} {:>6} {:>6} {:>6} {:>6} {:>6} {:>8} {:>8} {:>6} {:>7} {:>7} {:>7}\n",
                  "rays", "tree", "asked", "place", "choice", "in tr.", "cache", "in h.", "nodes", "leaves",
                  "leaf", "splits", "MB", "build");
  int lights = 0;
  ClassReport more;
  for (const ClassReport& c : report.classes) {
    if (c.queries() == 0) continue;
    if (c.rays == Rays::kLight && ++lights > kMostLights) {
      more.tree = c.tree;
      more.add(c);
      continue;
    }
    out += line(class_name(c, statistics), c);
  }
  if (lights > kMostLights) out += line(fmt::format("{} more lights", lights - kMostLights), more);
  out +=
      fmt::format("{:<36}{:.1f} MB used, {:.1f} MB held, of {:.1f} MB{}\n",
                  "Memory of trees:", static_cast<double>(report.pool_used) / 1e6,
                  static_cast<double>(report.pool_held) / 1e6, static_cast<double>(report.pool_budget) / 1e6,
                  report.pool_exhausted ? "; trees had to stop growing" : "");
  return out;
}

void write_classes(const RenderStatistics& statistics, JsonWriter& j) {
  const IntersectorReport& report = statistics.intersector;
  j.begin_object("trees");
  j.value("method", name_of(report.method));
  if (report.method == Method::kTrees) {
    j.begin_object("memory");
    j.value("used_bytes", report.pool_used).value("held_bytes", report.pool_held);
    j.value("budget_bytes", report.pool_budget).value("exhausted", report.pool_exhausted);
    j.end_object();
    j.begin_array("classes");
    for (const ClassReport& c : report.classes) {
      const fas::TreeCounts& t = c.in_tree;
      j.begin_object();
      j.value("class", class_name(c, statistics)).value("tree", name_of(c.tree));
      j.value("rays", c.queries()).value("rays_in_tree", t.rays);
      j.value("left_by_place", c.left_by_place()).value("left_by_choice", c.left_by_choice());
      j.value("tests_in_tree", t.tests).value("hits_in_tree", t.hits).value("looked_at", t.blocks);
      j.value("outside", t.outside).value("last_leaf", t.cached_leaf).value("last_occluder", t.cached_hit);
      j.value("tests_in_hierarchy", c.in_hierarchy.tests);
      j.value("bounds_tests_in_hierarchy", c.in_hierarchy.bounds_tests);
      j.value("nodes", t.nodes).value("leaves", t.leaves).value("candidates", t.candidates);
      j.value("splits", t.splits).value("truncated", t.truncated).value("bytes", t.bytes);
      j.value("build_seconds", 1e-9 * static_cast<double>(t.nanoseconds));
      j.end_object();
    }
    j.end_array();
  }
  j.end_object();
}

}  // namespace rayshade
