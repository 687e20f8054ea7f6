// SPDX-License-Identifier: MIT
// What the symbols of the grammar carry. Everything is trivially copyable, because Bison moves its stack with
// memcpy; the two kinds that own memory (a time-varying Value, Arguments) have destructors in the grammar.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "rayshade/lang/span.h"
#include "rayshade/math/vec.h"
#include "rayshade/scene/expression.h"
#include "rayshade/scene/node.h"
#include "rayshade/scene/texture.h"

namespace rayshade::lang {

/// A word of the scanned text, in place.
struct Name {
  const char* data;
  std::size_t size;
  std::string_view view() const { return {data, size}; }
};

/// A time-varying expression with the measures that keep later recursion and evaluation bounded.
struct Varying {
  Expression expression;
  int depth = 1;    ///< levels of the tree
  double size = 1;  ///< operations of one evaluation
};

/// A value of an expression: a plain number, or a tree if `varying` is set, which it then owns.
struct Value {
  double constant;
  Varying* varying;
};

inline void destroy(Value& value) {
  delete value.varying;
  value.varying = nullptr;
}

/// Arguments of a function call; owns its values.
struct Arguments {
  std::vector<Value> values;
  Arguments() = default;
  Arguments(const Arguments&) = delete;
  Arguments& operator=(const Arguments&) = delete;
  ~Arguments() {
    for (Value& value : values) destroy(value);
  }
};

/// A Span as Bison wants it: a location type that may be copied as bytes is initialised with four numbers.
struct GrammarSpan : Span {
  GrammarSpan() = default;
  GrammarSpan(int, int, int, int) {}
};

union SemanticValue {
  SemanticValue() : number(0) {}
  double number;
  int integer;
  bool flag;
  Name name;
  Vec3 vector;
  Color color;
  Value value;
  Arguments* arguments;
  NodeId node;
  MappingKind mapping;
  ImageComponent component;
};

}  // namespace rayshade::lang
