// SPDX-License-Identifier: MIT
// See surfaces.h.
#include "rayshade/lang/surfaces.h"

#include <fmt/format.h>

#include "rayshade/lang/keywords.h"
#include "rayshade/lang/suggest.h"

namespace rayshade::lang {

std::uint32_t Surfaces::default_index() {
  if (default_index_ == kNone) {
    default_index_ = static_cast<std::uint32_t>(context_.scene.surfaces.size());
    context_.scene.surfaces.push_back(default_surface());
  }
  return default_index_;
}

void Surfaces::start_named(Name name, const Span& span) {
  const auto found = named_.find(name.view());
  if (found != named_.end()) {
    origin_ = found->second.index;
    return;
  }
  Suggestion suggestion(name.view());
  for (const auto& [known, entry] : named_) suggestion.offer(known);
  // A misspelt component looks like a name.
  for (const Keyword& keyword : keywords()) suggestion.offer(keyword.name);
  context_.messages.error(span, fmt::format("there is no surface '{}'", name.view()), suggestion.text());
  origin_ = default_index();
}

void Surfaces::start_current(std::uint32_t current) {
  origin_ = current == kNone ? default_index() : current;
}

void Surfaces::start_new() {
  origin_ = kNone;
  work_ = Surface();
}

Surface& Surfaces::change() {
  if (origin_ != kNone) {
    work_ = context_.scene.surfaces[origin_];
    origin_ = kNone;
  }
  return work_;
}

void Surfaces::translucency(double share, const Color& color, double exponent) {
  Surface& surface = change();
  surface.translucency = share;
  surface.translucent = color;
  surface.transmitted_exponent = exponent;
}

void Surfaces::finish(const Span& span) {
  waiting_ = true;
  if (origin_ != kNone) return;  // it was checked when it was made
  if (work_.transparency > kEpsilon && work_.index <= 0) {
    context_.messages.error(
        span, fmt::format("a transparent surface needs an index of refraction above 0, not {}", work_.index));
  }
}

std::uint32_t Surfaces::index() {
  waiting_ = false;
  if (origin_ != kNone) return origin_;
  context_.scene.surfaces.push_back(work_);
  return static_cast<std::uint32_t>(context_.scene.surfaces.size() - 1);
}

Surface Surfaces::value() {
  waiting_ = false;
  return origin_ != kNone ? context_.scene.surfaces[origin_] : work_;
}

void Surfaces::define(Name name, const Span& span) {
  if (!waiting_) start_new();
  const Named entry{index(), span};
  const auto [known, fresh] = named_.try_emplace(std::string(name.view()), entry);
  if (fresh) return;
  context_.messages.warning(span, fmt::format("surface '{}' is defined again", name.view()));
  context_.messages.note(known->second.span, "it was defined here");
  known->second = entry;
}

}  // namespace rayshade::lang
