// SPDX-License-Identifier: MIT
// Runs the built program on every scene of tests/scene/checks and compares its pictures with what the
// original drew (or with what its defects should have been). Each check is a test of its own:
// --gtest_filter=textures.S22.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <sstream>

#include "tests/program/run.h"
#include "tests/scene/bytes_picture.h"
#include "tests/scene/check_file.h"

namespace rayshade::checks {
namespace {

namespace fs = std::filesystem;
using testing_tools::write_file;

/// A 5 x 4 picture with alpha as Utah RLE, the bottom row first.
std::string rgba_as_rle() {
  const auto word = [](int v) { return std::string{static_cast<char>(v & 255), static_cast<char>(v >> 8)}; };
  std::string out = "\x52\xCC" + word(0) + word(0) + word(5) + word(4);
  out += std::string{6, 3, 8, 0, 0, 0};  // alpha, no background; 3 colours of 8 bits; no map; a filler byte
  for (int y = 0; y < 4; ++y) {
    for (const int channel : {255, 0, 1, 2}) {
      out += std::string{2, static_cast<char>(channel), 5, 4};
      for (int x = 0; x < 5; ++x) {
        const int color[3] = {40 * x + 10, 60 * y + 5, std::min(255, 30 * x * y + 7)};
        out += static_cast<char>(channel == 255 ? 85 * ((x + 2 * y) % 4) : color[channel]);
      }
      out += '\0';
    }
    out += std::string{1, 1};
  }
  return out + std::string{7, 0};
}

/// The files that the texture checks name (textures.md 9).
void write_auxiliary_files(const fs::path& folder) {
  std::ostringstream ramp;
  for (int i = 0; i < 256; ++i) ramp << i << ' ' << 255 - i << ' ' << 7 * i % 256 << '\n';
  write_file(folder / "ramp.map", ramp.str());
  write_file(folder / "short.map", "255 0 0\n0 255 0\n");
  std::string tiny = "5 4\n";
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 5; ++x) {
      for (const int code : {40 * x + 10, 60 * y + 5, std::min(255, 30 * x * y + 7)})
        tiny += static_cast<char>(code);
    }
  }
  write_file(folder / "tiny.img", tiny);
  std::string gray = "P5\n5 4\n255\n";
  for (int y = 3; y >= 0; --y) {  // a PGM begins at the top, v = 0 is the bottom
    for (int x = 0; x < 5; ++x) gray += static_cast<char>((37 * x + 61 * y + 20) % 256);
  }
  write_file(folder / "gray.pgm", gray);
  write_file(folder / "rgba.rle", rgba_as_rle());
}

/// Renders the checks of one file, and remembers the pictures that others refer to.
class Gallery {
 public:
  explicit Gallery(std::vector<Check> checks) : checks_(std::move(checks)) {
    write_auxiliary_files(folder_.path());
  }

  const std::vector<Check>& checks() const { return checks_; }

  Picture render(const Check& check, const std::string& options) {
    write_file(folder_.path() / "scene.ray", check.scene);
    fs::remove(folder_.path() / "out.ppm");
    const auto outcome =
        testing_tools::run(folder_.path(), "-q " + options + " -O out.ppm scene.ray", {}, 120);
    if (outcome.status != 0) {
      throw std::runtime_error("exit status " + std::to_string(outcome.status) + ": " + outcome.err);
    }
    return read_ppm(testing_tools::read_file(folder_.path() / "out.ppm"));
  }

  /// The picture of the first run of a check.
  const Picture& picture_of(const std::string& name) {
    const auto known = pictures_.find(name);
    if (known != pictures_.end()) return known->second;
    for (const Check& check : checks_) {
      if (check.name == name) return pictures_[name] = render(check, check.runs.front().options);
    }
    throw std::runtime_error("no check named " + name);
  }

 private:
  std::vector<Check> checks_;
  testing_tools::Folder folder_;
  std::map<std::string, Picture> pictures_;
};

std::string text(const Pixel& p) {
  return std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]);
}

bool near(const Pixel& a, const Pixel& b, int tolerance) {
  for (std::size_t c = 0; c < 3; ++c) {
    if (std::abs(a[c] - b[c]) > tolerance) return false;
  }
  return true;
}

/// Reads the words of one expectation and tests it.
class Expectation {
 public:
  Expectation(const std::string& line, const Picture& picture, Gallery& gallery)
      : line_(line), in_(line), picture_(picture), gallery_(gallery) {}

  void test() {
    const std::string kind = word();
    if (kind == "pixel") {
      test_pixel(0);
    } else if (kind == "near") {
      test_pixel(1);
    } else if (kind == "every") {
      test_every();
    } else if (kind == "equal") {
      EXPECT_TRUE(picture_ == gallery_.picture_of(word())) << line_;
    } else if (kind == "different") {
      EXPECT_FALSE(picture_ == gallery_.picture_of(word())) << line_;
    } else if (kind == "swapped") {
      test_swapped();
    } else if (kind == "lit") {
      test_lit();
    } else if (kind == "levels") {
      test_levels();
    } else if (kind == "maximum") {
      test_maximum();
    } else if (kind == "range") {
      test_range();
    } else if (kind == "mean") {
      test_mean();
    } else if (kind == "deviation") {
      test_deviation();
    } else {
      throw std::runtime_error("unknown expectation: " + line_);
    }
    std::string rest;
    if (in_ >> rest) throw std::runtime_error("too many words: " + line_);
  }

 private:
  template <typename Value>
  Value read() {
    Value value;
    if (!(in_ >> value)) throw std::runtime_error("incomplete expectation: " + line_);
    return value;
  }
  std::string word() { return read<std::string>(); }
  int integer() { return read<int>(); }
  void expect_word(const std::string& expected) {
    if (word() != expected) throw std::runtime_error("expected \"" + expected + "\": " + line_);
  }
  Pixel pixel() {
    const int r = integer(), g = integer(), b = integer();
    return {r, g, b};
  }
  /// The number after `within`; 0 without.
  int tolerance() {
    std::string next;
    if (!(in_ >> next)) return 0;
    if (next != "within") throw std::runtime_error("expected \"within\": " + line_);
    return integer();
  }

  void test_pixel(int allowed) {
    const int x = integer(), y = integer();
    expect_word("=");
    const Pixel expected = pixel();
    const Pixel& got = picture_.at(x, y);
    EXPECT_TRUE(near(got, expected, allowed)) << line_ << ", got " << text(got);
  }

  void test_every() {
    expect_word("=");
    const Pixel expected = pixel();
    const auto wrong = std::find_if(picture_.pixels.begin(), picture_.pixels.end(),
                                    [&](const Pixel& p) { return p != expected; });
    EXPECT_TRUE(wrong == picture_.pixels.end()) << line_ << ", but there is " << text(*wrong);
  }

  void test_swapped() {
    Picture expected = gallery_.picture_of(word());
    const Pixel a = pixel(), b = pixel();
    std::size_t changed = 0;
    for (Pixel& p : expected.pixels) {
      changed += p == a || p == b;
      p = p == a ? b : p == b ? a : p;
    }
    EXPECT_EQ(changed, expected.pixels.size()) << line_;
    EXPECT_TRUE(picture_ == expected) << line_;
  }

  void test_lit() {
    const std::string count = word();
    const Lit lit = lit_pixels(picture_);
    int allowed_count = 0;
    std::string next = word();
    if (next == "within") {
      allowed_count = integer();
      next = word();
    }
    if (next != "columns") throw std::runtime_error("expected \"columns\": " + line_);
    const int left = integer(), right = integer();
    int top = lit.top, bottom = lit.bottom, allowed = 0;
    while (in_ >> next) {
      if (next == "rows") {
        top = integer();
        bottom = integer();
      } else if (next == "within") {
        allowed = integer();
      } else {
        throw std::runtime_error("unknown word: " + line_);
      }
    }
    in_.clear();
    if (count != "*") {
      EXPECT_NEAR(lit.count, std::stoi(count), allowed_count) << line_;
    }
    EXPECT_NEAR(lit.left, left, allowed) << line_;
    EXPECT_NEAR(lit.right, right, allowed) << line_;
    EXPECT_NEAR(lit.top, top, allowed) << line_;
    EXPECT_NEAR(lit.bottom, bottom, allowed) << line_;
  }

  void test_levels() {
    std::set<int> expected;
    for (int level; in_ >> level;) expected.insert(level);
    in_.clear();
    EXPECT_EQ(lit_pixels(picture_).levels, expected) << line_;
  }

  void test_maximum() {
    const int expected = integer();
    int largest = 0;
    for (const Pixel& p : picture_.pixels) largest = std::max({largest, p[0], p[1], p[2]});
    EXPECT_NEAR(largest, expected, tolerance()) << line_;
  }

  void test_range() {
    expect_word("red");
    const int low = integer(), high = integer();
    for (const Pixel& p : picture_.pixels) {
      ASSERT_GE(p[0], low) << line_;
      ASSERT_LE(p[0], high) << line_;
    }
  }

  void test_mean() {
    const double expected[3] = {read<double>(), read<double>(), read<double>()};
    const int allowed = tolerance();
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(moments(picture_, c).mean, expected[c], allowed) << line_;
  }

  void test_deviation() {
    expect_word("red");
    const double expected = read<double>();
    EXPECT_NEAR(moments(picture_, 0).deviation, expected, tolerance()) << line_;
  }

  std::string line_;
  std::istringstream in_;
  const Picture& picture_;
  Gallery& gallery_;
};

class CheckTest : public testing::Test {
 public:
  CheckTest(std::shared_ptr<Gallery> gallery, std::size_t index)
      : gallery_(std::move(gallery)), index_(index) {}

  void TestBody() override {
    const Check& check = gallery_->checks()[index_];
    std::size_t expectations = 0;
    for (const checks::Run& run : check.runs) {
      SCOPED_TRACE("options: " + run.options);
      try {
        const Picture picture = gallery_->render(check, run.options);
        for (const std::string& line : run.expectations) {
          Expectation(line, picture, *gallery_).test();
          ++expectations;
        }
      } catch (const std::exception& error) {
        ADD_FAILURE() << error.what() << "\n" << check.scene;
      }
    }
    if (expectations > 0 || HasFailure()) return;
    // A picture that others are compared with must at least show something.
    EXPECT_GT(lit_pixels(gallery_->picture_of(check.name)).count, 0);
  }

 private:
  std::shared_ptr<Gallery> gallery_;
  std::size_t index_;
};

void register_checks(const fs::path& file) {
  const auto gallery = std::make_shared<Gallery>(read_checks(file));
  for (std::size_t i = 0; i < gallery->checks().size(); ++i) {
    const Check& check = gallery->checks()[i];
    testing::RegisterTest(file.stem().c_str(), check.name.c_str(), nullptr, nullptr, file.c_str(), check.line,
                          [gallery, i] { return new CheckTest(gallery, i); });
  }
}

}  // namespace
}  // namespace rayshade::checks

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::filesystem::path folder = SOURCE_DIR "/tests/scene/checks";
  for (const char* name : {"textures", "shading", "language", "media"}) {
    rayshade::checks::register_checks(folder / (std::string(name) + ".checks"));
  }
  return RUN_ALL_TESTS();
}
