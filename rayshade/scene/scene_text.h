// SPDX-License-Identifier: MIT
// The parts of a scene as canonical text (see canonical_text.cpp): settings, lights, shapes, surfaces,
// transforms and textures, each as one run of words without a line end. Numbers are the shortest decimals
// that read back the same.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "rayshade/scene/scene.h"

namespace rayshade {

/// Whether `text` is a STRING of the language (1.1): a letter, then letters, digits, dots, underscores and
/// dashes.
bool is_language_name(std::string_view text);

/// How numbers are written.
enum class NumberForm : std::uint8_t {
  kDecimal,
  /// A zero byte and the eight bytes of the double, the lowest first; all NaNs alike. Two texts in this form
  /// are equal exactly where their decimal forms are, and it takes a fraction of the time: for hashing.
  kBits,
};

/// Appends words and numbers to a text, one blank between them.
class TextWriter {
 public:
  explicit TextWriter(NumberForm form = NumberForm::kDecimal) : form_(form) {}
  /// Hands the text over, and forgets it, at the first line end after every `piece` bytes: for who needs it
  /// only once.
  TextWriter(NumberForm form, std::size_t piece, std::function<void(const std::string&)> take)
      : form_(form), piece_(piece), take_(std::move(take)) {}
  NumberForm form() const { return form_; }
  void word(std::string_view text);
  void number(double value);
  void integer(std::int64_t value);
  void vec(const Vec3& v);
  void color(const Color& c);
  /// A file name: bare where the language reads it as one word that is no keyword, in quotes otherwise.
  void file(const std::string& name);
  /// `keyword` and `value`, where there is a value.
  void optional_number(std::string_view keyword, const std::optional<double>& value);
  void optional_color(std::string_view keyword, const std::optional<Color>& value);
  void optional_vec(std::string_view keyword, const std::optional<Vec3>& value);
  /// Ends the line; the next one is indented by `depth` levels.
  void end_line(int depth = 0);
  const std::string& text() const { return text_; }

 private:
  void separate();
  NumberForm form_;
  std::string text_;
  std::size_t piece_ = 0;
  std::function<void(const std::string&)> take_;
};

/// Names for surfaces of equal value, numbered in the order of first use. The surfaces must outlive it and
/// stay where they are.
class SurfaceNames {
 public:
  const std::string& name(const Surface& surface);
  /// Writes `surface NAME ...` with every component, one line each.
  void write_definitions(TextWriter& out) const;

 private:
  struct Named {
    const Surface* surface;  // the first of its value
    const std::string* name;
  };
  std::unordered_map<std::string, std::string> names_;                 // components in bits -> name
  std::unordered_map<const Surface*, const std::string*> by_address_;  // those asked for before
  std::vector<Named> order_;
};

/// Writes everything that is set, one line each.
void write_settings(TextWriter& out, const SceneSettings& settings);
void write_light(TextWriter& out, const Light& light);
/// Keyword, surface (where the node has one) and arguments of a primitive.
void write_primitive(TextWriter& out, const Scene& scene, const Node& node, SurfaceNames& surfaces);
void write_transforms(TextWriter& out, const TransformList& list);
void write_texture(TextWriter& out, const Texture& texture, SurfaceNames& surfaces);

}  // namespace rayshade
