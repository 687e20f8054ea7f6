// SPDX-License-Identifier: MIT
// See expected.h.
#include "rayshade/lang/expected.h"

#include <algorithm>
#include <set>

namespace rayshade::lang {
namespace {

constexpr std::size_t kMostTold = 8;

const std::vector<std::string_view>& item_words() {
  static const std::vector<std::string_view> words = {
      "eyep",         "lookp",   "up",     "fov",     "aperture",  "focaldist", "eyesep",      "screen",
      "window",       "crop",    "sample", "filter",  "contrast",  "cutoff",    "maxdepth",    "background",
      "shadowtransp", "outfile", "report", "shutter", "frames",    "starttime", "framelength", "light",
      "atmosphere",   "define",  "print",  "surface", "applysurf", "name",      "end of file"};
  return words;
}
const std::vector<std::string_view>& object_words() {
  static const std::vector<std::string_view> words = {
      "plane", "sphere", "box",         "disc", "cylinder", "cone",  "torus",     "triangle",   "triangleuv",
      "poly",  "blob",   "heightfield", "list", "grid",     "union", "intersect", "difference", "object"};
  return words;
}
const std::vector<std::string_view>& component_words() {
  static const std::vector<std::string_view> words = {"ambient", "diffuse", "specular", "body",
                                                      "specpow", "reflect", "transp",   "index",
                                                      "extinct", "translu", "noshadow"};
  return words;
}

}  // namespace

std::string describe_expected(const std::vector<std::string_view>& symbols, bool inside) {
  std::set<std::string_view> left(symbols.begin(), symbols.end());
  std::vector<std::string> told;
  const auto holds = [&](const std::vector<std::string_view>& words) {
    return std::all_of(words.begin(), words.end(), [&](std::string_view w) { return left.contains(w); });
  };
  const auto remove = [&](const std::vector<std::string_view>& words) {
    for (const std::string_view word : words) left.erase(word);
  };
  const auto group = [&](const char* name, const std::vector<std::string_view>& words) {
    if (!holds(words)) return;
    remove(words);
    if (*name) told.emplace_back(name);
  };
  group("a number", {"a number", "'+'", "'-'", "'('"});
  group("a file name", {"a name", "a file name", "a quoted file name"});
  // What can begin the next item or member says little about a mistake inside this one.
  // The automaton shares states between the top level and aggregates; only one of the two is true here.
  const bool next_member = inside && left.contains("end");
  const bool next_item = !inside && holds(item_words());
  if (holds(item_words())) remove(item_words());
  if (holds(object_words())) {
    remove(object_words());
    if (next_member || next_item) remove({"surface", "applysurf", "name", "end"});
    told.emplace_back(next_item ? "a new item" : "an object");
    if (next_member) told.emplace_back("'end'");
  }
  group("a surface component", component_words());
  group("a transform", {"scale", "translate", "rotate", "transform"});
  group("an operator", {"'+'", "'-'", "'*'", "'/'", "'%'", "'^'"});
  for (const std::string_view word : left) {
    const bool plain = word.substr(0, 2) == "a " || word.front() == '\'' || word == "end of file";
    told.push_back(plain ? std::string(word) : "'" + std::string(word) + "'");
  }
  if (told.empty() || told.size() > kMostTold) return {};
  std::string out = told.front();
  for (std::size_t i = 1; i < told.size(); ++i) out += (i + 1 == told.size() ? " or " : ", ") + told[i];
  return out;
}

}  // namespace rayshade::lang
