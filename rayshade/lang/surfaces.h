// SPDX-License-Identifier: MIT
// Surface descriptions (language.md 3.6). One description is under work at a time: a start (named, current or
// new), changes of components, finish; then whoever asked for it takes it, as an index or as a value.
#pragma once

#include "rayshade/lang/context.h"
#include "rayshade/lang/semantic.h"

namespace rayshade::lang {

class Surfaces {
 public:
  explicit Surfaces(Context& context) : context_(context) {}

  void start_named(Name name, const Span& span);
  /// `current` is the index of the current surface, or kNone.
  void start_current(std::uint32_t current);
  void start_new();
  /// The surface under work, which becomes a copy of what it started from.
  Surface& change();
  void translucency(double share, const Color& color, double exponent);
  void finish(const Span& span);

  /// Whether a finished surface waits to be taken.
  bool waiting() const { return waiting_; }
  /// Takes the finished surface as an index into Scene::surfaces; an unchanged named or current one is
  /// shared.
  std::uint32_t index();
  /// Takes the finished surface as a value.
  Surface value();
  /// The statement `surface X [...]`: takes what waits, or a new surface.
  void define(Name name, const Span& span);
  /// Drops unfinished work, after a mistake.
  void recover() { waiting_ = false; }

 private:
  struct Named {
    std::uint32_t index;
    Span span;
  };

  std::uint32_t default_index();

  Context& context_;
  NameMap<Named> named_;
  Surface work_;
  std::uint32_t origin_ = kNone;  ///< index of what the work started from, while unchanged
  bool waiting_ = false;
  std::uint32_t default_index_ = kNone;
};

}  // namespace rayshade::lang
