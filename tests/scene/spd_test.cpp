// SPDX-License-Identifier: MIT
// The generator of the Standard Procedural Databases: its Rayshade text against published data of the default
// sizes, object by object, and its counts, extents and formats at other sizes against the known formulas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "scenes/spd/databases.h"

namespace rayshade::spd {
namespace {

struct Object {
  std::string kind;
  std::vector<double> numbers;
  std::map<std::string, std::vector<double>> surface;
};

struct Listing {
  std::map<std::string, std::vector<double>> view;  // eyep, lookp, up, fov, screen, background
  std::vector<std::vector<double>> lights;          // intensity, x, y, z
  std::vector<Object> objects;
};

bool is_number(const std::string& word) {
  return std::isdigit(static_cast<unsigned char>(word[0])) || word[0] == '-' || word[0] == '.';
}

// The part of the scene language that the databases use. Words other than keywords are names of surfaces.
Listing parse(const std::string& text) {
  static const std::set<std::string> kinds = {"sphere", "cone", "polygon", "triangle"};
  static const std::set<std::string> views = {"eyep", "lookp", "up", "fov", "screen", "background"};
  static const std::set<std::string> components = {"ambient", "diffuse", "specular", "specpow",
                                                   "reflect", "transp",  "index"};
  Listing out;
  std::map<std::string, std::map<std::string, std::vector<double>>> surfaces;
  std::string defining, applied;
  std::vector<double>* numbers = nullptr;
  std::istringstream in(text);
  for (std::string word; in >> word;) {
    if (word.starts_with("/*")) {
      while (!word.ends_with("*/") && in >> word) continue;
    } else if (is_number(word)) {
      if (numbers == nullptr) throw std::runtime_error("a number out of place: " + word);
      numbers->push_back(std::stod(word));
    } else if (kinds.contains(word)) {
      out.objects.push_back({word, {}, {}});
      if (!applied.empty()) out.objects.back().surface = surfaces.at(applied);
      numbers = &out.objects.back().numbers;
    } else if (views.contains(word) || word == "sample" || word == "grid") {
      numbers = &out.view[word];
    } else if (components.contains(word)) {
      numbers = &surfaces[defining][word];
    } else if (word == "light") {
      numbers = &out.lights.emplace_back();
    } else if (word == "surface") {
      in >> defining;
      surfaces[defining];
    } else if (word == "applysurf") {
      in >> applied;
    } else if (surfaces.contains(word)) {
      out.objects.back().surface = surfaces.at(word);
    } else if (word != "point" && word != "end" && word != "nojitter") {
      throw std::runtime_error("unknown word " + word);
    }
  }
  return out;
}

std::string generate(const std::string& name, int size, const std::string& format) {
  std::ostringstream out;
  const auto writer = make_writer(format, out);
  find_database(name)->generate(size, *writer);
  writer->finish();
  return out.str();
}

std::string unpack(const std::filesystem::path& path) {
  std::string text;
  gzFile file = gzopen(path.c_str(), "rb");
  char buffer[65536];
  for (int n; file != nullptr && (n = gzread(file, buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(n));
  if (file != nullptr) gzclose(file);
  return text;
}

// The published numbers have six digits.
bool close(double ours, double theirs) {
  return std::fabs(ours - theirs) <=
         std::max(1e-4 * std::min(std::fabs(theirs), 0.1), 1e-5 * std::fabs(theirs)) + 2e-6;
}

bool close(const std::vector<double>& ours, const std::vector<double>& theirs) {
  if (ours.size() != theirs.size()) return false;
  for (std::size_t i = 0; i < ours.size(); ++i)
    if (!close(ours[i], theirs[i])) return false;
  return true;
}

class Published : public testing::TestWithParam<const char*> {};

TEST_P(Published, AgreesObjectByObject) {
  const std::filesystem::path path =
      std::filesystem::path(SOURCE_DIR) / "../shared/reference/spd" / (std::string(GetParam()) + ".ray.gz");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no published data at " << path;
  const Listing theirs = parse(unpack(path));
  const Listing ours = parse(generate(GetParam(), find_database(GetParam())->default_size, "rayshade"));

  ASSERT_FALSE(theirs.objects.empty());
  EXPECT_EQ(ours.objects.size(), theirs.objects.size());
  for (const char* key : {"eyep", "lookp", "up", "fov", "screen", "background", "sample", "grid"})
    EXPECT_TRUE(close(ours.view.at(key), theirs.view.at(key))) << key;
  ASSERT_EQ(ours.lights.size(), theirs.lights.size());
  for (std::size_t i = 0; i < ours.lights.size(); ++i)
    EXPECT_TRUE(close(ours.lights[i], theirs.lights[i])) << i;

  int wrong = 0;
  for (std::size_t i = 0; i < std::min(ours.objects.size(), theirs.objects.size()) && wrong < 5; ++i) {
    const Object &a = ours.objects[i], &b = theirs.objects[i];
    bool same = a.kind == b.kind && close(a.numbers, b.numbers) && a.surface.size() == b.surface.size();
    for (const auto& [component, values] : b.surface)
      same = same && a.surface.contains(component) && close(a.surface.at(component), values);
    if (same) continue;
    ++wrong;
    ADD_FAILURE() << "object " << i << ": " << a.kind << ' ' << testing::PrintToString(a.numbers) << ' '
                  << testing::PrintToString(a.surface) << "\npublished: " << b.kind << ' '
                  << testing::PrintToString(b.numbers) << ' ' << testing::PrintToString(b.surface);
  }
}

INSTANTIATE_TEST_SUITE_P(Spd, Published,
                         testing::Values("balls", "gears", "mount", "rings", "teapot", "tetra", "tree"));

// Counts by kind, of the package's own table of sizes.
struct Count {
  const char* name;
  int size;
  std::map<std::string, std::size_t> kinds;
};

class Counts : public testing::TestWithParam<Count> {};

TEST_P(Counts, FollowTheFormulas) {
  const auto& [name, size, kinds] = GetParam();
  const Listing listing = parse(generate(name, size, "rayshade"));
  std::map<std::string, std::size_t> found;
  for (const Object& object : listing.objects) ++found[object.kind];
  EXPECT_EQ(found, kinds);
  EXPECT_EQ(find_database(name)->count(size), static_cast<std::int64_t>(listing.objects.size()));
}

INSTANTIATE_TEST_SUITE_P(
    Spd, Counts,
    testing::Values(Count{"balls", 1, {{"sphere", 10}, {"polygon", 1}}},
                    Count{"balls", 2, {{"sphere", 91}, {"polygon", 1}}},
                    Count{"balls", 3, {{"sphere", 820}, {"polygon", 1}}},
                    Count{"gears", 1, {{"polygon", 147}}}, Count{"gears", 2, {{"polygon", 1169}}},
                    Count{"gears", 3, {{"polygon", 3943}}},
                    Count{"mount", 1, {{"polygon", 8}, {"sphere", 4}}},
                    Count{"mount", 4, {{"polygon", 512}, {"sphere", 4}}},
                    Count{"mount", 8, {{"polygon", 131072}, {"sphere", 4}}},
                    Count{"rings", 1, {{"polygon", 1}, {"cone", 30}, {"sphere", 30}}},
                    Count{"rings", 3, {{"polygon", 1}, {"cone", 420}, {"sphere", 420}}},
                    Count{"teapot", 1, {{"polygon", 1}, {"triangle", 56}}},
                    Count{"teapot", 12, {{"polygon", 144}, {"triangle", 9120}}},
                    Count{"tetra", 1, {{"polygon", 4}}}, Count{"tetra", 5, {{"polygon", 1024}}},
                    Count{"tree", 1, {{"polygon", 1}, {"cone", 3}, {"sphere", 3}}},
                    Count{"tree", 8, {{"polygon", 1}, {"cone", 511}, {"sphere", 511}}}),
    [](const auto& test) { return std::string(test.param.name) + std::to_string(test.param.size); });

TEST(Spd, BallsTouchTheirParents) {
  const Listing listing = parse(generate("balls", 2, "rayshade"));
  // Depth first: sphere 1 is the ground's successor, then each child with its nine.
  const auto& objects = listing.objects;
  ASSERT_EQ(objects.size(), 92u);
  for (int child = 0; child < 9; ++child) {
    const auto& a = objects[1].numbers;
    const auto& b = objects[2 + 10 * child].numbers;
    EXPECT_NEAR(std::hypot(a[1] - b[1], a[2] - b[2], a[3] - b[3]), a[0] + b[0], 1e-9);
    for (int other = 0; other < child; ++other) {
      const auto& c = objects[2 + 10 * other].numbers;
      EXPECT_GE(std::hypot(c[1] - b[1], c[2] - b[2], c[3] - b[3]), c[0] + b[0] - 1e-9) << "siblings overlap";
    }
  }
}

TEST(Spd, MountKeepsItsFormAtEverySize) {
  std::map<std::pair<double, double>, double> coarse, fine;
  const auto heights = [](int size) {
    std::map<std::pair<double, double>, double> out;
    for (const Object& object : parse(generate("mount", size, "rayshade")).objects)
      if (object.kind == "polygon")
        for (int i = 0; i < 3; ++i) {
          const auto& n = object.numbers;
          const auto [place, fresh] = out.emplace(std::pair(n[3 * i], n[3 * i + 1]), n[3 * i + 2]);
          EXPECT_EQ(place->second, n[3 * i + 2]) << "a crack";
        }
    return out;
  };
  coarse = heights(3);
  fine = heights(5);
  ASSERT_EQ(coarse.size(), 81u);
  ASSERT_EQ(fine.size(), 1089u);
  double largest = 0;
  for (const auto& [place, height] : coarse) {
    EXPECT_EQ(fine.at(place), height);
    largest = std::max(largest, std::fabs(height));
  }
  EXPECT_GT(largest, 0.3);
}

// On a fine mesh vertex normals and facets agree but for the knob's waist, where the surface is pinched to a
// point.
TEST(Spd, TeapotNormalsFitItsFacets) {
  int corners = 0, poor = 0;
  for (const Object& object : parse(generate("teapot", 16, "rayshade")).objects) {
    if (object.kind != "triangle") continue;
    Vec3 p[3], n[3];
    for (int i = 0; i < 3; ++i) {
      const double* v = &object.numbers[6 * i];
      p[i] = {v[0], v[1], v[2]};
      n[i] = {v[3], v[4], v[5]};
      EXPECT_NEAR(length(n[i]), 1, 1e-8);
    }
    const Vec3 facet = normalize(cross(p[1] - p[0], p[2] - p[0]));
    for (const Vec3& normal : n) {
      ++corners;
      if (dot(facet, normal) < 0.9) ++poor;
    }
  }
  EXPECT_LT(poor, corners / 50) << "of " << corners;
}

std::size_t count_lines(const std::string& text, const std::string& start) {
  std::istringstream in(text);
  std::size_t count = 0;
  for (std::string line; std::getline(in, line);) count += line.starts_with(start);
  return count;
}

// Every format has the same objects.
TEST(Spd, FormatsAgreeInCounts) {
  for (const Database& database : databases()) {
    const std::string name(database.name);
    const Listing ours = parse(generate(name, 2, "rayshade"));
    std::map<std::string, std::size_t> kinds;
    for (const Object& object : ours.objects) ++kinds[object.kind];
    const std::string nff = generate(name, 2, "nff"), pov = generate(name, 2, "pov");
    EXPECT_EQ(count_lines(nff, "s "), kinds["sphere"]) << name;
    EXPECT_EQ(count_lines(nff, "p "), kinds["polygon"]) << name;
    EXPECT_EQ(count_lines(nff, "pp "), kinds["triangle"]) << name;
    EXPECT_EQ(count_lines(nff, "c"), kinds["cone"]) << name;
    EXPECT_EQ(count_lines(nff, "l "), ours.lights.size()) << name;
    EXPECT_EQ(count_lines(pov, "sphere {"), kinds["sphere"]) << name;
    EXPECT_EQ(count_lines(pov, "polygon {"), kinds["polygon"]) << name;
    EXPECT_EQ(count_lines(pov, "smooth_triangle {"), kinds["triangle"]) << name;
    EXPECT_EQ(count_lines(pov, "cone {") + count_lines(pov, "cylinder {"), kinds["cone"]) << name;
    EXPECT_EQ(std::count(pov.begin(), pov.end(), '{'), std::count(pov.begin(), pov.end(), '}')) << name;
  }
}

// The picture of the POV-Ray scene is that of the Rayshade scene: one gear of five is a solid with one
// interior, the ground mirrors what the specular colour leaves, every secondary ray of Rayshade's exists.
TEST(Spd, PovDescribesTheSameWork) {
  const std::string pov = generate("gears", 2, "pov");
  EXPECT_EQ(count_lines(pov, "  interior {"), 2u);
  EXPECT_EQ(count_lines(pov, "union {"), 2u);
  const auto start = pov.find("union {"), end = pov.find(" material {", start);
  EXPECT_EQ(count_lines(pov.substr(start, end - start), "polygon {"), 146u);
  EXPECT_NE(pov.find("phong 0.3 phong_size 3.0827 reflection 0.18 "), std::string::npos);
  EXPECT_NE(pov.find("max_trace_level 6 "), std::string::npos);
}

TEST(Spd, UnknownNamesAreNull) {
  std::ostringstream out;
  EXPECT_EQ(make_writer("obj", out), nullptr);
  EXPECT_EQ(find_database("ball"), nullptr);
  EXPECT_EQ(number(-1e-17), "0");
  EXPECT_EQ(number(0.1), "0.1");
}

}  // namespace
}  // namespace rayshade::spd
