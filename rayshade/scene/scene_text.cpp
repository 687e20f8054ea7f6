// SPDX-License-Identifier: MIT
// Words, file names, surfaces, settings, lights and transforms as canonical text.
#include "rayshade/scene/scene_text.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "rayshade/scene/number_text.h"

namespace rayshade {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// language.md 1.3 FILENAME or STRING, and no keyword: those consist of small letters only.
bool is_bare_file_name(std::string_view text) {
  if (std::all_of(text.begin(), text.end(), [](char c) { return c >= 'a' && c <= 'z'; })) return false;
  for (int i = 0; i < 2 && text.starts_with('/'); ++i) text.remove_prefix(1);
  for (std::size_t slash = text.find('/'); slash != std::string_view::npos; slash = text.find('/')) {
    const std::string_view component = text.substr(0, slash);
    if (component != "." && component != ".." && !is_language_name(component)) return false;
    text.remove_prefix(slash + 1);
  }
  return is_language_name(text);
}

void write_effect(TextWriter& out, const AtmosphereEffect& effect) {
  switch (effect.kind) {
    case EffectKind::kFog:
      out.word("fog");
      out.color(effect.color);
      out.color(effect.thickness);
      break;
    case EffectKind::kMist:
      out.word("mist");
      out.color(effect.color);
      out.color(effect.thickness);
      out.number(effect.zero);
      out.number(effect.scale);
      break;
    case EffectKind::kFogDeck:
      out.word("fogdeck");
      out.number(effect.altitude);
      out.number(effect.offset);
      out.vec(effect.noise_scale);
      out.number(effect.chaos_scale);
      out.integer(effect.octaves);
      out.color(effect.color);
      out.color(effect.thickness);
      break;
  }
}

void write_components(TextWriter& out, const Surface& s) {
  out.word("ambient");
  out.color(s.ambient);
  out.word("diffuse");
  out.color(s.diffuse);
  out.word("specular");
  out.color(s.specular);
  out.word("specpow");
  out.number(s.specular_exponent);
  out.word("body");
  out.color(s.body);
  out.word("reflect");
  out.number(s.reflectance);
  out.word("transp");
  out.number(s.transparency);
  out.word("index");
  out.number(s.index);
  out.word("extinct");
  out.number(s.extinction);
  out.word("translu");
  out.number(s.translucency);
  out.color(s.translucent);
  out.number(s.transmitted_exponent);
  if (s.no_shadow) out.word("noshadow");
}

}  // namespace

bool is_language_name(std::string_view text) {
  return !text.empty() && is_letter(text[0]) && std::all_of(text.begin(), text.end(), [](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
  });
}

void TextWriter::separate() {
  if (!text_.empty() && text_.back() != ' ' && text_.back() != '\n') text_ += ' ';
}

void TextWriter::word(std::string_view text) {
  separate();
  text_ += text;
}

void TextWriter::number(double value) {
  if (form_ == NumberForm::kBits) {
    if (std::isnan(value)) value = std::numeric_limits<double>::quiet_NaN();
    auto bits = std::bit_cast<std::uint64_t>(value);
    char bytes[9];
    bytes[0] = '\0';  // which no word holds
    for (int i = 1; i < 9; ++i, bits >>= 8) bytes[i] = static_cast<char>(bits & 0xff);
    text_.append(bytes, sizeof bytes);
    return;
  }
  separate();
  append_number(text_, value);
}

void TextWriter::integer(std::int64_t value) { word(std::to_string(value)); }

void TextWriter::vec(const Vec3& v) {
  number(v.x);
  number(v.y);
  number(v.z);
}

void TextWriter::color(const Color& c) { vec({c.r, c.g, c.b}); }

void TextWriter::file(const std::string& name) { word(is_bare_file_name(name) ? name : '"' + name + '"'); }

void TextWriter::optional_number(std::string_view keyword, const std::optional<double>& value) {
  if (!value) return;
  word(keyword);
  number(*value);
  end_line();
}

void TextWriter::optional_color(std::string_view keyword, const std::optional<Color>& value) {
  if (!value) return;
  word(keyword);
  color(*value);
  end_line();
}

void TextWriter::optional_vec(std::string_view keyword, const std::optional<Vec3>& value) {
  if (!value) return;
  word(keyword);
  vec(*value);
  end_line();
}

void TextWriter::end_line(int depth) {
  if (take_ && text_.size() >= piece_) {
    take_(text_);
    text_.clear();
  }
  text_ += '\n';
  text_.append(2 * static_cast<std::size_t>(std::min(depth, 20)), ' ');
}

const std::string& SurfaceNames::name(const Surface& surface) {
  const auto [known, first_time] = by_address_.try_emplace(&surface);
  if (first_time) {
    TextWriter components(NumberForm::kBits);
    write_components(components, surface);
    const auto [entry, added] = names_.try_emplace(components.text());
    if (added) {
      entry->second = "surface_" + std::to_string(names_.size());
      order_.push_back({&surface, &entry->second});
    }
    known->second = &entry->second;
  }
  return *known->second;
}

void SurfaceNames::write_definitions(TextWriter& out) const {
  for (const Named& entry : order_) {
    out.word("surface");
    out.word(*entry.name);
    write_components(out, *entry.surface);
    out.end_line();
  }
}

void write_settings(TextWriter& out, const SceneSettings& s) {
  out.optional_vec("eyep", s.eye);
  out.optional_vec("lookp", s.look);
  out.optional_vec("up", s.up);
  if (s.horizontal_fov || s.vertical_fov) {
    out.word("fov");
    out.number(s.horizontal_fov.value_or(RenderSettings{}.horizontal_fov));
    if (s.vertical_fov) out.number(*s.vertical_fov);
    out.end_line();
  }
  out.optional_number("aperture", s.aperture);
  out.optional_number("focaldist", s.focal_distance);
  out.optional_number("eyesep", s.eye_separation);
  if (s.screen) {
    out.word("screen");
    for (const int side : *s.screen) out.integer(side);
    out.end_line();
  }
  if (s.window) {
    out.word("window");
    for (const int bound : *s.window) out.integer(bound);
    out.end_line();
  }
  if (s.crop) {
    out.word("crop");
    for (const double bound : *s.crop) out.number(bound);
    out.end_line();
  }
  if (s.samples || s.jitter) {
    out.word("sample");
    out.integer(s.samples.value_or(-1));  // -1: unset
    if (s.jitter) out.word(*s.jitter ? "jitter" : "nojitter");
    out.end_line();
  }
  if (s.filter || s.filter_width) {
    out.word("filter");
    out.word(s.filter.value_or(FilterKind::kBox) == FilterKind::kBox ? "box" : "gauss");
    if (s.filter_width) out.number(*s.filter_width);
    out.end_line();
  }
  out.optional_color("contrast", s.contrast);
  out.optional_color("cutoff", s.cutoff);
  if (s.max_depth) {
    out.word("maxdepth");
    out.integer(*s.max_depth);
    out.end_line();
  }
  out.optional_color("background", s.background);
  if (s.toggle_transparent_shadows) {
    out.word("shadowtransp");
    out.end_line();
  }
  if (s.output) {
    out.word("outfile");
    out.file(*s.output);
    out.end_line();
  }
  if (s.verbose || s.quiet || s.report_frequency || s.report_file) {
    out.word("report");
    if (s.verbose) out.word("verbose");
    if (s.quiet) out.word("quiet");
    if (s.report_frequency) out.integer(*s.report_frequency);
    if (s.report_file) out.file(*s.report_file);
    out.end_line();
  }
  out.optional_number("shutter", s.shutter);
  if (s.frames) {
    out.word("frames");
    out.integer(*s.frames);
    out.end_line();
  }
  out.optional_number("starttime", s.start_time);
  out.optional_number("framelength", s.frame_length);
  if (s.ambient_light) {
    out.word("light");
    out.color(*s.ambient_light);
    out.word("ambient");
    out.end_line();
  }
  if (s.atmosphere_index || !s.effects.empty()) {
    out.word("atmosphere");
    if (s.atmosphere_index) out.number(*s.atmosphere_index);
    for (const AtmosphereEffect& effect : s.effects) write_effect(out, effect);
    out.end_line();
  }
}

void write_light(TextWriter& out, const Light& light) {
  out.word("light");
  out.color(light.intensity);
  switch (light.kind) {
    case LightKind::kPoint:
      out.word("point");
      out.vec(light.position);
      break;
    case LightKind::kDirectional:
      out.word("directional");
      out.vec(light.position);
      break;
    case LightKind::kSpot:
      out.word("spot");
      out.vec(light.position);
      out.vec(light.target);
      out.number(light.exponent);
      out.number(light.inner);
      out.number(light.outer);
      break;
    case LightKind::kExtended:
      out.word("extended");
      out.number(light.radius);
      out.vec(light.position);
      break;
    case LightKind::kArea:
      out.word("area");
      out.vec(light.position);
      out.vec(light.u_end);
      out.integer(light.u_samples);
      out.vec(light.v_end);
      out.integer(light.v_samples);
      break;
  }
  if (light.no_shadow) out.word("noshadow");
}

void write_transforms(TextWriter& out, const TransformList& list) {
  const auto affine = [&](const Affine& map) {
    out.word("transform");
    for (const Vec3& row : map.rows) out.vec(row);
    out.vec(map.translation);
  };
  for (const TransformList::Element& element : list.elements()) {
    if (!element.animated) {
      affine(element.constant);
      continue;
    }
    std::size_t count = 3;
    switch (element.animated->kind) {
      case StepKind::kScale:
        out.word("scale");
        break;
      case StepKind::kTranslate:
        out.word("translate");
        break;
      case StepKind::kRotate:
        out.word("rotate");
        count = 4;
        break;
      case StepKind::kMatrix:
        out.word("transform");
        count = 12;
        break;
    }
    for (std::size_t i = 0; i < count; ++i) out.word(element.animated->arguments[i].text());
  }
}

}  // namespace rayshade
