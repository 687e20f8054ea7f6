// SPDX-License-Identifier: MIT
// Transforms (language.md 3.8, objects.md 1.4 to 1.7). The run under work is taken by the object or texture
// that it follows; constant ones are folded by TransformList.
#pragma once

#include "rayshade/lang/expressions.h"

namespace rayshade::lang {

class Transforms {
 public:
  Transforms(Context& context, Expressions& expressions) : context_(context), expressions_(expressions) {}
  ~Transforms() { recover(); }
  Transforms(const Transforms&) = delete;
  Transforms& operator=(const Transforms&) = delete;

  void scale(Value x, Value y, Value z, const Span& span);
  void translate(Value x, Value y, Value z, const Span& span);
  void rotate(Value x, Value y, Value z, Value degrees, const Span& span);
  /// One row of three values of `transform`.
  void row(Value x, Value y, Value z);
  /// `transform` with the rows since the last one: three, or four with a translation.
  void matrix(const Span& span);

  /// The run so far, which becomes empty.
  TransformList take();
  /// Drops unfinished work, after a mistake.
  void recover();

 private:
  void step(StepKind kind, std::array<Expression, 12> arguments, const Span& span);
  void append(const Affine& map, const Span& span);

  Context& context_;
  Expressions& expressions_;
  TransformList list_;
  Span last_;  ///< of the last constant transform
  std::vector<Value> rows_;
};

}  // namespace rayshade::lang
