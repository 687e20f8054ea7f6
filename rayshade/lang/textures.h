// SPDX-License-Identifier: MIT
// Textures and mappings (language.md 3.9). One texture is under work at a time: start, options, finish; the
// object that they follow takes them all.
#pragma once

#include <initializer_list>
#include <utility>

#include "rayshade/lang/context.h"
#include "rayshade/lang/semantic.h"

namespace rayshade::lang {

class Textures {
 public:
  explicit Textures(Context& context) : context_(context) {}

  /// Arguments in the order of Texture::arguments.
  void start(TextureKind kind, std::initializer_list<double> arguments = {});
  void start(TextureKind kind, std::initializer_list<double> arguments, int octaves,
             const Span& octaves_span);
  void start(TextureKind kind, const Surface& surface, std::initializer_list<double> arguments = {});
  void start(TextureKind kind, Name file, const Span& file_span,
             std::initializer_list<double> arguments = {});
  void file(Name name, const Span& span);
  ImageOptions& image() { return work_.image; }
  void tile(double u, double v);
  void range(double high, double low);
  void second_surface(const Surface& surface);
  void mapping(MappingKind kind);
  /// `up` is the v axis of a planar mapping.
  void mapping(MappingKind kind, const Vec3& origin, const Vec3& up, const Vec3& u_axis, const Span& span);
  void finish(TransformList transform, const Span& span);

  /// The textures since the last call.
  std::vector<Texture> take() { return std::exchange(done_, {}); }
  /// Drops unfinished work, after a mistake.
  void recover() { done_.clear(); }

 private:
  Context& context_;
  Texture work_;
  std::vector<Texture> done_;
};

}  // namespace rayshade::lang
