// SPDX-License-Identifier: MIT
// Canonical text against the parser: random scenes are parsed, written, and parsed again. The second scene
// must have the same text, and every primitive of its world the same arguments, surface, transforms and
// textures.
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "rayshade/lang/parse.h"
#include "rayshade/scene/scene_text.h"

namespace rayshade {
namespace {

/// Writes random scenes in the language: scopes, `applysurf`, names in and outside of aggregates, instances,
/// animated transforms and all textures.
class SceneWriter {
 public:
  explicit SceneWriter(unsigned seed) : random_(seed) {}

  std::string scene() {
    text_.clear();
    objects_ = surfaces_ = symbols_ = 0;
    if (chance(2)) text_ += "eyep 0 -8 1 rotate 0 0 1 3\n";
    if (chance(2)) text_ += "screen 64 48\nwindow 3 40 2 30\n";
    if (chance(2)) text_ += "sample 2 nojitter\nfilter gauss\n";
    if (chance(2)) text_ += "fov 40\ncontrast 0 0.1 (1/3)\nbackground .1 .2 .3\n";
    if (chance(2)) text_ += "atmosphere 1.25 fog 1 1 1 2 2 2 mist 1 0 0 5 5 5 -1 .3\n";
    if (chance(2)) text_ += "light 0.3 ambient\nlight 1 point 1 2 3 noshadow\n";
    if (chance(2)) text_ += "light 1 1 .5 spot 1 2 3 0 0 0 5\nlight 1 area 0 0 9 1 0 9 2 0 1 9 3\n";
    if (chance(2)) text_ += "frames 3\nshutter .5\nreport verbose 7 log.txt\noutfile ./a.ppm\n";
    const int items = 3 + below(12);
    for (int i = 0; i < items; ++i) item(3, true);
    text_ += "sphere 1 0 0 0\n";  // never an empty world
    return text_;
  }

 private:
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  bool chance(int n) { return below(n) == 0; }

  std::string number() {
    static const char* const kNumbers[] = {"1",     "2.5",  "-3",        ".125", "1e-3",
                                           "(1/3)", "-0.1", "(sqrt(2))", "7e5"};
    return std::string(kNumbers[below(static_cast<int>(std::size(kNumbers)))]) + " ";
  }
  std::string numbers(int n) {
    std::string out;
    while (n-- > 0) out += number();
    return out;
  }

  std::string expression(int depth) {
    switch (depth == 0 ? below(3) : below(10)) {
      case 0:
        return "time";
      case 1:
        return "0.5";
      case 2:
        return symbols_ > 0 ? "s" + std::to_string(below(symbols_)) : "frame";
      case 3:
        return expression(depth - 1) + " + " + expression(depth - 1);
      case 4:
        return expression(depth - 1) + " - (" + expression(depth - 1) + ")";
      case 5:
        return "(" + expression(depth - 1) + ") * " + expression(depth - 1);
      case 6:
        return "-" + expression(depth - 1) + " ^ 2";
      case 7:
        return "sin(" + expression(depth - 1) + ")";
      case 8:
        return "linear(0, " + expression(depth - 1) + ", 1, -2)";
      default:
        return "(2 + sin(" + expression(depth - 1) + ")) ^ -sin(" + expression(depth - 1) + ")";
    }
  }
  std::string value() { return chance(3) ? "(" + expression(3) + ") " : number(); }
  std::string values(int n) {
    std::string out;
    while (n-- > 0) out += value();
    return out;
  }

  std::string components() {
    std::string out;
    const int count = 1 + below(3);
    for (int i = 0; i < count; ++i) {
      static const char* const kComponents[] = {
          "ambient .1 .2 .3 ",     "diffuse .5 0 0 ", "specular 1 1 1 ", "specpow 20 ",         "reflect .5 ",
          "transp .25 index 1.5 ", "body .9 1 .8 ",   "extinct .7 ",     "translu .2 1 0 0 5 ", "noshadow "};
      out += kComponents[below(static_cast<int>(std::size(kComponents)))];
    }
    return out;
  }
  std::string surface() {
    switch (below(4)) {
      case 0:
        return "cursurf ";
      case 1:
        return "cursurf " + components();
      case 2:
        return surfaces_ > 0 ? "f" + std::to_string(below(surfaces_)) + " " : components();
      default:
        return components();
    }
  }
  std::string maybe_surface() { return chance(3) ? surface() : ""; }

  std::string transforms() {
    std::string out;
    for (int n = chance(2) ? 0 : below(4); n > 0; --n) {
      switch (below(4)) {
        case 0:
          out += "translate " + values(3);
          break;
        case 1:
          out += "scale 2 " + value() + "3 ";
          break;
        case 2:
          out += "rotate 0 .5 1 " + value();
          break;
        default:
          out += "transform 1 0 0 .25 2 0 0 (time) 1 " + (chance(2) ? values(3) : std::string());
      }
    }
    return out;
  }
  std::string textures() {
    std::string out;
    for (int n = chance(2) ? 0 : below(3); n > 0; --n) {
      out += "texture ";
      switch (below(14)) {
        case 0:
          out += "checker " + surface();
          break;
        case 1:
          out += "blotch .5 " + surface();
          break;
        case 2:
          out += "bump .5 ";
          break;
        case 3:
          out += chance(2) ? "marble " : "marble dir/m.map ";
          break;
        case 4:
          out += "fbm " + numbers(4) + "4 .5 ";
          break;
        case 5:
          out += "fbmbump " + numbers(4) + "4 ";
          break;
        case 6:
          out += "wood ";
          break;
        case 7:
          out += "gloss .5 ";
          break;
        case 8:
          out += "cloud 1 2 3 4 5 6 7 ";
          break;
        case 9:
          out += "sky 1 2 3 4 5 6 ";
          break;
        case 10:
          out += "stripe " + surface() + ".5 .25 " + (chance(2) ? "map cylindrical " : "");
          break;
        case 11:
          out += "windy 1 2 3 4 5 6 7 8 ";
          break;
        case 12:
          out += "mount \"a b\" 1 2 ";
          break;
        default:
          out += "image \"scale\" component bump range 2 1 smooth tile 1 2 textsurf " + surface() +
                 "map planar 0 0 0 0 1 0 1 0 0 ";
      }
      if (chance(2)) out += transforms();
    }
    return out;
  }

  std::string primitive() {
    switch (below(9)) {
      case 0:
        return "sphere " + maybe_surface() + "1 " + numbers(3);
      case 1:
        return "box " + maybe_surface() + "0 0 0 1 2 3 ";
      case 2:
        return "plane " + maybe_surface() + "0 0 0 0 0 1 ";
      case 3:
        return "cone " + maybe_surface() + "1 0 0 0 .5 0 0 1 ";
      case 4:
        return "triangle " + maybe_surface() + "0 0 0 1 0 0 0 1 0 ";
      case 5:
        return "poly " + maybe_surface() + "0 0 0 1 0 0 1 1 0 0 1 0 ";
      case 6:
        return "blob " + maybe_surface() + ".5 1 1 0 0 0 1 1 1 0 0 ";
      case 7:
        return "torus " + maybe_surface() + "2 .5 0 0 0 0 0 1 ";
      default:
        return "heightfield " + maybe_surface() + "land.hf ";
    }
  }

  void instance(int depth) {
    const int kind = below(10);
    if (kind < 3 && depth > 0) {
      static const char* const kOpenings[] = {"list", "grid 2 3 4", "union", "intersect", "difference"};
      const int opening = below(5);
      text_ += std::string(kOpenings[opening]) + "\n";
      if (opening >= 2) {
        for (int i = 0; i < 2; ++i) instance(depth - 1);
      } else {
        instance(depth - 1);
        for (int i = below(4); i > 0; --i) item(depth - 1, false);
      }
      text_ += "end ";
    } else if (kind < 6 && objects_ > 0) {
      text_ += "object " + (chance(4) ? components() : std::string()) + "o" +
               std::to_string(below(objects_)) + " ";
    } else {
      text_ += primitive();
    }
    text_ += transforms() + textures() + "\n";
  }

  void item(int depth, bool top) {
    const int kind = below(8);
    if (kind == 0) {
      text_ += "applysurf " + surface() + "\n";
    } else if (kind == 1) {
      text_ += "surface f" + std::to_string(surfaces_) + " " + surface() + "\n";
      ++surfaces_;
    } else if (kind == 2) {
      // Sometimes an old name again: later uses mean the new object.
      const int index = objects_ > 0 && chance(4) ? below(objects_) : -1;
      text_ += "name o" + std::to_string(index < 0 ? objects_ : index) + " ";
      const int before = objects_;
      instance(depth);
      if (index < 0) objects_ = before + 1;
    } else if (kind == 3 && top) {
      text_ += "define s" + std::to_string(symbols_) + " (" + expression(2) + ")\n";
      ++symbols_;
    } else {
      instance(depth);
    }
  }

  std::mt19937 random_;
  std::string text_;
  int objects_ = 0, surfaces_ = 0, symbols_ = 0;
};

/// Everything that shading sees of each primitive in the world, one line each, in order.
class Flattener {
 public:
  Flattener(const Scene& scene, SurfaceNames& names) : scene_(scene), names_(names) {}

  std::vector<std::string> world() {
    for (const NodeId id : scene_.world) visit(id, "", "");
    return std::move(lines_);
  }

 private:
  /// `outside` is what the nodes around add; `shape` are the aggregates on the way.
  void visit(NodeId id, const std::string& shape, const std::string& outside,
             std::uint32_t inherited = kNone) {
    if (lines_.size() > 3000) return;  // instances multiply
    const Node& node = scene_.nodes[id];
    TextWriter own;
    if (node.transform != kNone) write_transforms(own, scene_.transforms[node.transform]);
    if (node.textures != kNone) {
      for (const Texture& texture : scene_.texture_lists[node.textures]) write_texture(own, texture, names_);
    }
    const std::string around = own.text().empty() ? outside : "[" + own.text() + "] " + outside;
    // The surface nearest to the primitive decides.
    const std::uint32_t surface = node.surface != kNone ? node.surface : inherited;
    if (is_primitive(node.kind)) {
      Node bare = node;
      bare.surface = kNone;
      TextWriter line;
      write_primitive(line, scene_, bare, names_);
      lines_.push_back(shape + line.text() + " | " +
                       (surface == kNone ? "none" : names_.name(scene_.surfaces[surface])) + " | " + around);
    } else if (node.kind == NodeKind::kInstance) {
      visit(scene_.named_objects[node.payload].node, shape, around, surface);
    } else {
      const std::string inner = shape + std::to_string(static_cast<int>(node.kind)) + ">";
      for (const NodeId member : scene_.aggregates[node.payload].members)
        visit(member, inner, around, surface);
    }
  }

  const Scene& scene_;
  SurfaceNames& names_;
  std::vector<std::string> lines_;
};

ParseResult parsed(const std::string& text) {
  MemoryProvider memory;
  memory.add("scene", text);
  return parse_scene(memory, "scene");
}

std::string first_error(const ParseResult& result) {
  for (const Diagnostic& d : result.diagnostics) {
    if (d.severity == Severity::kError)
      return std::to_string(d.location.line) + ": " + d.text + "\n" + d.source_line;
  }
  return "";
}

TEST(RoundTripTest, CanonicalTextMeansTheSameScene) {
  const unsigned seed = 2718;
  SCOPED_TRACE("seed " + std::to_string(seed));
  SceneWriter writer(seed);
  std::size_t primitives = 0, with_surface = 0, refused = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::string text = writer.scene();
    const ParseResult first = parsed(text);
    if (!first.ok) {  // a constant that came out as 0 / 0, a scale of 0
      ++refused;
      continue;
    }
    const std::string canonical = canonical_text(first.scene);
    const ParseResult second = parsed(canonical);
    ASSERT_TRUE(second.ok) << first_error(second) << "\n" << text << "\n---\n" << canonical;
    ASSERT_EQ(canonical_text(second.scene), canonical) << text;

    SurfaceNames names;
    const std::vector<std::string> before = Flattener(first.scene, names).world();
    const std::vector<std::string> after = Flattener(second.scene, names).world();
    ASSERT_EQ(before, after) << text << "\n---\n" << canonical;
    primitives += before.size();
    for (const std::string& line : before) with_surface += line.find("| none |") == std::string::npos;
  }
  EXPECT_LT(refused, 300u);
  // The generator must reach what this test is about.
  EXPECT_GT(primitives, 10000u);
  EXPECT_GT(with_surface, 5000u);
  EXPECT_GT(primitives - with_surface, 2000u);
}

}  // namespace
}  // namespace rayshade
