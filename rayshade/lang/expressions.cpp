// SPDX-License-Identifier: MIT
// See expressions.h.
#include "rayshade/lang/expressions.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "rayshade/lang/suggest.h"

namespace rayshade::lang {
namespace {

/// Whether truncation gives an int (and the remainder of two such ints is defined).
bool fits_int(double number) { return number > -2147483649.0 && number < 2147483648.0; }

}  // namespace

Expressions::Expressions(Context& context) : context_(context) {
  const auto variable = [&](const char* name, const Expression& value) {
    Symbol symbol;
    symbol.value.expression = value;
    symbol.predefined = true;
    symbols_.emplace(name, symbol);
  };
  const auto function = [&](const char* name, Operation operation, std::size_t arity) {
    Symbol symbol;
    symbol.kind = SymbolKind::kFunction;
    symbol.function = operation;
    symbol.arity = arity;
    symbol.predefined = true;
    symbols_.emplace(name, symbol);
  };
  variable("pi", 3.141592);  // these rounded values are what scenes rely on (language.md 10, KEEP 3)
  variable("dtor", 0.017453);
  variable("rtod", 57.29578);
  variable("time", Expression::time());
  variable("frame", Expression::frame());
  function("sin", Operation::kSin, 1);
  function("cos", Operation::kCos, 1);
  function("tan", Operation::kTan, 1);
  function("asin", Operation::kAsin, 1);
  function("acos", Operation::kAcos, 1);
  function("atan", Operation::kAtan, 1);
  function("sqrt", Operation::kSqrt, 1);
  function("hypot", Operation::kHypot, 2);
  function("linear", Operation::kLinear, 4);
}

const Expressions::Symbol* Expressions::find(Name name, const Span& span) {
  const auto found = symbols_.find(name.view());
  if (found != symbols_.end()) return &found->second;
  // A dash belongs to the name in front of it: the commonest cause of an unknown symbol.
  std::string hint;
  const std::size_t dash = name.view().find('-');
  if (dash != std::string_view::npos && defined(name.view().substr(0, dash))) {
    hint = fmt::format("for a subtraction write blanks: '{} - {}'", name.view().substr(0, dash),
                       name.view().substr(dash + 1));
  } else {
    Suggestion suggestion(name.view());
    for (const auto& [known, symbol] : symbols_) suggestion.offer(known);
    hint = suggestion.text();
  }
  context_.messages.error(span, fmt::format("there is no symbol '{}'", name.view()), hint);
  return nullptr;
}

Value Expressions::variable(Name name, const Span& span) {
  const Symbol* symbol = find(name, span);
  if (!symbol) return {1, nullptr};
  if (symbol->kind == SymbolKind::kFunction) {
    context_.messages.error(
        span, fmt::format("'{}' is a function and needs arguments in parentheses", name.view()));
    return {1, nullptr};
  }
  const Expression& value = symbol->value.expression;
  if (value.constant()) return {value.evaluate(Moment{}), nullptr};
  return {0, new Varying(symbol->value)};
}

Value Expressions::call(Name name, const Span& name_span, Arguments* arguments, const Span& span) {
  const std::unique_ptr<Arguments> owner(arguments);
  const Symbol* symbol = find(name, name_span);
  if (!symbol) return {1, nullptr};
  if (symbol->kind != SymbolKind::kFunction) {
    context_.messages.error(name_span, fmt::format("'{}' is not a function", name.view()));
    return {1, nullptr};
  }
  if (arguments->values.size() != symbol->arity) {
    context_.messages.error(span, fmt::format("'{}' takes {} argument{}, not {}", name.view(), symbol->arity,
                                              symbol->arity == 1 ? "" : "s", arguments->values.size()));
    return {1, nullptr};
  }
  return apply(symbol->function, arguments->values.data(), symbol->arity, span);
}

bool Expressions::check_remainder(const Value& a, const Value& b, const Span& span) {
  const bool bad_left = !a.varying && !fits_int(a.constant);
  const bool bad_right = !b.varying && !fits_int(b.constant);
  if (bad_left || bad_right) {
    context_.messages.error(span, "an operand of '%' does not fit an integer");
  } else if (!b.varying && std::trunc(b.constant) == 0) {
    context_.messages.error(span, "division by zero: the right operand of '%' is truncated to 0");
  } else {
    return true;
  }
  return false;
}

Value Expressions::binary(Operation operation, Value a, Value b, const Span& span) {
  Value operands[2] = {a, b};
  if (operation == Operation::kRemainder && !check_remainder(a, b, span)) {
    destroy(operands[0]);
    destroy(operands[1]);
    return {1, nullptr};
  }
  return apply(operation, operands, 2, span);
}

Value Expressions::negate(Value a, const Span& span) { return apply(Operation::kNegate, &a, 1, span); }

/// Consumes the operands.
Value Expressions::apply(Operation operation, Value* operands, std::size_t count, const Span& span) {
  std::array<Expression, 4> expressions;
  int depth = 1;
  double size = 1;
  for (std::size_t i = 0; i < count; ++i) {
    Value& operand = operands[i];
    if (!operand.varying) {
      expressions[i] = operand.constant;
      continue;
    }
    depth = std::max(depth, operand.varying->depth + 1);
    size += operand.varying->size;
    expressions[i] = std::move(operand.varying->expression);
    destroy(operand);
  }
  if (depth > kMostExpressionLevels || size > kMostExpressionOperations) {
    context_.messages.error(span, "this time-varying expression is too large");
    context_.messages.stop();
    return {1, nullptr};
  }
  Expression result = Expression::apply(operation, std::move(expressions));
  if (result.constant()) return {result.evaluate(Moment{}), nullptr};
  return {0, new Varying{std::move(result), depth, size}};
}

Arguments* Expressions::first_argument(Value value) {
  auto arguments = std::make_unique<Arguments>();
  arguments->values.push_back(value);
  return arguments.release();
}

Arguments* Expressions::next_argument(Arguments* arguments, Value value) {
  arguments->values.push_back(value);
  return arguments;
}

double Expressions::constant(Value value, const Span& span) {
  if (value.varying) {
    destroy(value);
    context_.messages.error(span, "this value must not vary with time; only transforms and 'define' may");
    return 1;
  }
  if (std::isfinite(value.constant)) return value.constant;
  context_.messages.error(span, fmt::format("this value is not a finite number ({})", value.constant));
  return 1;
}

Expression Expressions::take(Value value, const Span& span) {
  if (!value.varying) return constant(value, span);
  Expression expression = std::move(value.varying->expression);
  destroy(value);
  return expression;
}

int Expressions::integer(double number, const Span& span) {
  if (fits_int(number)) return static_cast<int>(number);
  context_.messages.error(span, "this number is too large for an integer");
  return 1;
}

void Expressions::define(Name name, const Span& span, Value value) {
  const auto known = symbols_.find(name.view());
  if (known != symbols_.end()) {
    destroy(value);
    if (known->second.predefined) {
      context_.messages.error(span, fmt::format("'{}' is a predefined symbol", name.view()));
      return;
    }
    context_.messages.error(span, fmt::format("symbol '{}' is already defined", name.view()));
    context_.messages.note(known->second.span, "it was defined here");
    return;
  }
  Symbol symbol;
  symbol.span = span;
  if (value.varying) {
    symbol.value = std::move(*value.varying);
    destroy(value);
  } else {
    symbol.value.expression = value.constant;
  }
  symbols_.emplace(name.view(), std::move(symbol));
}

void Expressions::print(Value value, const Span& span) {
  if (context_.messages.errors() > 0) return destroy(value);  // it may stand in for one that was wrong
  // Unlike a value that is used, a printed one may be infinite or undefined.
  if (!value.varying) {
    context_.prints.push_back(fmt::format("{:f}\n", value.constant));
    return;
  }
  constant(value, span);
}

}  // namespace rayshade::lang
