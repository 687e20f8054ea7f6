// SPDX-License-Identifier: MIT
// See textures.h.
#include "rayshade/lang/textures.h"

#include <algorithm>

#include "rayshade/lang/settings_builder.h"

namespace rayshade::lang {

void Textures::start(TextureKind kind, std::initializer_list<double> arguments) {
  work_ = Texture();
  work_.kind = kind;
  std::copy(arguments.begin(), arguments.end(), work_.arguments);
}

void Textures::start(TextureKind kind, std::initializer_list<double> arguments, int octaves,
                     const Span& octaves_span) {
  start(kind, arguments);
  work_.octaves = checked_octaves(context_, octaves, octaves_span);
}

void Textures::start(TextureKind kind, const Surface& surface, std::initializer_list<double> arguments) {
  start(kind, arguments);
  work_.surface = surface;
}

void Textures::start(TextureKind kind, Name file_name, const Span& file_span,
                     std::initializer_list<double> arguments) {
  start(kind, arguments);
  file(file_name, file_span);
}

void Textures::file(Name name, const Span& span) {
  work_.file = {std::string(name.view()), context_.sources.locate(span)};
  if (name.size == 0) context_.messages.error(span, "a file name must not be empty");
}

void Textures::tile(double u, double v) {
  work_.image.tile_u = u;
  work_.image.tile_v = v;
}

void Textures::range(double high, double low) {
  work_.image.range_high = high;
  work_.image.range_low = low;
}

void Textures::second_surface(const Surface& surface) {
  work_.image.has_surface = true;
  work_.surface = surface;
}

void Textures::mapping(MappingKind kind) {
  work_.mapping = Mapping();
  work_.mapping.kind = kind;
}

void Textures::mapping(MappingKind kind, const Vec3& origin, const Vec3& up, const Vec3& u_axis,
                       const Span& span) {
  work_.mapping = {kind, true, origin, up, u_axis};
  // The axes must span a plane; how long they are does not matter.
  const double sine = length(cross(normalize(up), normalize(u_axis)));
  if (sine > 1e-14) return;
  context_.messages.error(span, kind == MappingKind::kPlanar
                                    ? "singular matrix: the axes of this mapping are parallel or zero"
                                    : "degenerate mapping vector: the axes are parallel or zero");
}

void Textures::finish(TransformList transform, const Span& span) {
  work_.transform = std::move(transform);
  work_.location = context_.sources.locate(span);
  done_.push_back(std::move(work_));
}

}  // namespace rayshade::lang
