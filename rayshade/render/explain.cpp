// SPDX-License-Identifier: MIT
#include "rayshade/render/explain.h"

#include <fmt/format.h>

namespace rayshade {
namespace {

std::string text_of(const Vec3& v) { return fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x, v.y, v.z); }
std::string text_of(const Color& c) { return fmt::format("[{:.6f} {:.6f} {:.6f}]", c.r, c.g, c.b); }

}  // namespace

std::string ExplainText::object_name(const Hit& hit) const {
  const Leaf& leaf = frame_.shading.compiled->leaves[hit.leaf];
  std::string out = fmt::format("{} {}", name_of(leaf.kind), frame_.numbers[hit.leaf]);
  if (hit.instances.count > 0) {
    out += " in instance";
    for (std::uint32_t i = 0; i < hit.instances.count; ++i)
      out += fmt::format(" {}", frame_.numbers[hit.instances.leaves[i]]);
  }
  return out;
}

void ExplainText::on_hit(const HitEvent& event) {
  Entry entry;
  entry.head = fmt::format("{}, depth {}, weight {}: from {} toward {}, time {:.6g}", name_of(event.kind),
                           event.depth, text_of(event.contribution), text_of(event.ray->origin),
                           text_of(event.ray->direction), event.ray->time);
  if (!event.found) {
    entry.lines.push_back("hits nothing: background " + text_of(frame_.shading.settings->background));
  } else {
    const WorldHit& world = event.surface->world;
    const Surface& s = event.surface->surface;
    entry.lines.push_back(fmt::format("hits {} at distance {:.12g}, {}", object_name(*event.hit),
                                      event.distance, world.entering ? "entering" : "leaving"));
    entry.lines.push_back(fmt::format("point {} normal {}, known within {:.2g}", text_of(world.point),
                                      text_of(world.normal), world.error));
    entry.lines.push_back(fmt::format("surface: ambient {} diffuse {} specular {} specpow {:g}",
                                      text_of(s.ambient), text_of(s.diffuse), text_of(s.specular),
                                      s.specular_exponent));
    if (s.reflectance != 0 || s.transparency != 0 || s.translucency != 0) {
      entry.lines.push_back(
          fmt::format("         reflect {:g} transp {:g} body {} index {:g} extinct {:g} translu {:g}",
                      s.reflectance, s.transparency, text_of(s.body), s.index, s.extinction, s.translucency));
    }
    entry.lines.push_back("ambient light gives " +
                          text_of(s.ambient * frame_.shading.settings->ambient_light));
  }
  entry.root = event.parent == kNone;
  const std::size_t number = entries_.size();
  entries_.push_back(std::move(entry));
  if (event.parent != kNone) entries_[open_.at(event.parent)].children.push_back(number);
  open_[event.node] = number;
}

void ExplainText::on_light(const LightEvent& event) {
  std::string line =
      fmt::format("{}: cosine {:.6g}, ", light_name(frame_.shading.lights, event.light), event.cosine);
  if (event.skipped)
    line += "no effect";
  else if (event.arriving == Color{})
    line += "in shadow";
  else
    line += fmt::format("arrives {}, adds {}", text_of(event.arriving), text_of(event.added));
  entries_[open_.at(event.node)].lines.push_back(std::move(line));
}

void ExplainText::on_finish(std::uint32_t node, const Color& color) {
  const auto found = open_.find(node);
  if (found == open_.end()) return;
  entries_[found->second].color = color;
  open_.erase(found);
}

void ExplainText::print(std::size_t number, int depth, std::string& out) const {
  const Entry& entry = entries_[number];
  const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
  out += indent + entry.head + "\n";
  for (const std::string& line : entry.lines) out.append(indent).append("  ").append(line).append("\n");
  for (const std::size_t child : entry.children) print(child, depth + 1, out);
  out += indent + "  colour " + text_of(entry.color) + "\n";
}

std::string ExplainText::text() const {
  std::string out;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].root) print(i, 0, out);
  }
  return out;
}

}  // namespace rayshade
