// SPDX-License-Identifier: MIT
#include "rayshade/image/format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rayshade {
namespace {

struct FormatEntry {
  std::string_view name;
  FileFormat format;
  PixelStorage storage;
  bool append, alpha, linear;
};

// The first entry of a format bears its name.
constexpr std::array kFormats = {
    FormatEntry{"png", FileFormat::kPng8, PixelStorage::kByte, false, true, false},
    FormatEntry{"png8", FileFormat::kPng8, PixelStorage::kByte, false, true, false},
    FormatEntry{"png16", FileFormat::kPng16, PixelStorage::kWord, false, true, false},
    FormatEntry{"ppm", FileFormat::kPpm, PixelStorage::kByte, true, false, false},
    FormatEntry{"pfm", FileFormat::kPfm, PixelStorage::kFloat, true, false, true},
    FormatEntry{"exr", FileFormat::kExr, PixelStorage::kFloat, false, true, true},
    FormatEntry{"rle", FileFormat::kRle, PixelStorage::kByte, true, true, false},
    FormatEntry{"rle-exponential", FileFormat::kRleExponential, PixelStorage::kExponential, true, true,
                false},
    FormatEntry{"raw", FileFormat::kRaw, PixelStorage::kByte, true, false, false},
};

struct SuffixEntry {
  std::string_view suffix;
  FileFormat format;
};

constexpr std::array kSuffixes = {
    SuffixEntry{".png", FileFormat::kPng8}, SuffixEntry{".ppm", FileFormat::kPpm},
    SuffixEntry{".pfm", FileFormat::kPfm},  SuffixEntry{".exr", FileFormat::kExr},
    SuffixEntry{".rle", FileFormat::kRle},  SuffixEntry{".raw", FileFormat::kRaw},
    SuffixEntry{".img", FileFormat::kRaw},
};

#ifdef RAYSHADE_HAVE_OPENEXR
constexpr bool kHaveExr = true;
#else
constexpr bool kHaveExr = false;
#endif

FileFormat available(FileFormat format) {
  if (format == FileFormat::kExr && !kHaveExr)
    throw FormatError("OpenEXR was left out of this build; use pfm for floating-point pictures");
  return format;
}

const FormatEntry& entry(FileFormat format) {
  for (const FormatEntry& e : kFormats)
    if (e.format == format) return e;
  throw FormatError("unknown picture format");
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Position of the suffix's dot in the last component of a path, npos without one. A leading dot starts no
/// suffix.
std::size_t suffix_start(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  const std::size_t name = slash == std::string_view::npos ? 0 : slash + 1;
  const std::size_t dot = path.rfind('.');
  return dot == std::string_view::npos || dot <= name ? std::string_view::npos : dot;
}

/// A pattern split at its number: what stands before and behind, with `%%` replaced, and the number's width.
struct Pattern {
  std::string before, after;
  bool numbered = false;
  int digits = 1;
};

Pattern parse(std::string_view text) {
  Pattern pattern;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string& part = pattern.numbered ? pattern.after : pattern.before;
    if (text[i] != '%') {
      part += text[i];
      continue;
    }
    const std::string_view rest = text.substr(i + 1);
    if (rest.starts_with('%')) {
      part += '%';
      ++i;
      continue;
    }
    std::size_t length = 0;
    int digits = 1;
    if (rest.starts_with('d')) {
      length = 1;
    } else if (rest.size() >= 3 && rest[0] == '0' && rest[1] >= '1' && rest[1] <= '9' && rest[2] == 'd') {
      length = 3;
      digits = rest[1] - '0';
    } else {
      throw FormatError(fmt::format("\"{}\": after % only d, 01d to 09d or % may stand", text));
    }
    if (pattern.numbered)
      throw FormatError(fmt::format("\"{}\": more than one place for the frame number", text));
    pattern.numbered = true;
    pattern.digits = digits;
    i += length;
  }
  return pattern;
}

}  // namespace

FileFormat format_by_name(std::string_view name) {
  for (const FormatEntry& e : kFormats)
    if (e.name == name) return available(e.format);
  std::string names;
  for (const FormatEntry& e : kFormats) {
    if (e.format == FileFormat::kExr && !kHaveExr) continue;
    names += names.empty() ? "" : ", ";
    names += e.name;
  }
  throw FormatError(fmt::format("unknown picture format \"{}\"; there are {}", name, names));
}

std::optional<FileFormat> format_by_suffix(std::string_view path) {
  const std::size_t start = suffix_start(path);
  if (start == std::string_view::npos) return std::nullopt;
  std::string suffix(path.substr(start));
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), lower);
  for (const SuffixEntry& e : kSuffixes)
    if (e.suffix == suffix) return available(e.format);
  return std::nullopt;
}

std::string_view format_name(FileFormat format) { return entry(format).name; }
PixelStorage storage_of(FileFormat format) { return entry(format).storage; }
bool can_append(FileFormat format) { return entry(format).append; }
bool has_alpha(FileFormat format) { return entry(format).alpha; }
bool is_linear(FileFormat format) { return entry(format).linear; }

bool is_numbered(std::string_view pattern) { return parse(pattern).numbered; }

std::string numbered_name(std::string_view pattern, std::int64_t frame) {
  const Pattern parts = parse(pattern);
  if (!parts.numbered) return parts.before;
  return fmt::format("{}{:0{}}{}", parts.before, frame, parts.digits, parts.after);
}

std::string partial_name(std::string_view path) {
  const std::size_t dot = suffix_start(path);
  if (dot == std::string_view::npos) return std::string(path) + ".partial";
  return std::string(path.substr(0, dot)) + ".partial" + std::string(path.substr(dot));
}

}  // namespace rayshade
