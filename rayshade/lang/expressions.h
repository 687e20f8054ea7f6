// SPDX-License-Identifier: MIT
// Numbers, symbols and expressions (language.md 3.1, 3.2). Constants are folded while parsing and cost no
// memory; only what depends on time becomes a tree, of bounded depth and size.
#pragma once

#include "rayshade/lang/context.h"
#include "rayshade/lang/semantic.h"

namespace rayshade::lang {

/// Levels of a time-varying expression, counted through `define`: evaluation and destruction recurse over
/// them.
inline constexpr int kMostExpressionLevels = 2000;
/// Operations of one evaluation, counted through `define`, which can double them with every line.
inline constexpr double kMostExpressionOperations = 1e5;

class Expressions {
 public:
  explicit Expressions(Context& context);

  Value variable(Name name, const Span& span);
  /// Consumes the arguments.
  Value call(Name name, const Span& name_span, Arguments* arguments, const Span& span);
  /// Consume their operands.
  Value binary(Operation operation, Value a, Value b, const Span& span);
  Value negate(Value a, const Span& span);
  Arguments* first_argument(Value value);
  Arguments* next_argument(Arguments* arguments, Value value);

  /// The value where only a constant is allowed, and only a finite one; reports anything else and gives 1.
  double constant(Value value, const Span& span);
  /// Truncation toward zero; a number that no int holds is reported and becomes 1.
  int integer(double number, const Span& span);
  /// The value where it may vary; a constant must be finite.
  Expression take(Value value, const Span& span);

  void define(Name name, const Span& span, Value value);
  void print(Value value, const Span& span);
  bool defined(std::string_view name) const { return symbols_.contains(name); }

 private:
  enum class SymbolKind : std::uint8_t { kVariable, kFunction };
  struct Symbol {
    SymbolKind kind = SymbolKind::kVariable;
    Operation function = Operation::kConstant;
    std::size_t arity = 0;
    Varying value;  ///< of a variable; a constant expression where it does not vary
    Span span;
    bool predefined = false;
  };

  const Symbol* find(Name name, const Span& span);
  Value apply(Operation operation, Value* operands, std::size_t count, const Span& span);
  bool check_remainder(const Value& a, const Value& b, const Span& span);

  Context& context_;
  NameMap<Symbol> symbols_;
};

}  // namespace rayshade::lang
