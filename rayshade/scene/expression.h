// SPDX-License-Identifier: MIT
// Values that may vary with time (language.md 3.2): immutable trees over `time` and `frame`, evaluated over
// doubles or, for conservative motion bounds, over an interval of times (rule 9). Constants carry no tree.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "rayshade/math/interval.h"

namespace rayshade {

enum class Operation : std::uint8_t {
  kConstant,
  kTime,
  kFrame,
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kRemainder,
  kPower,
  kNegate,
  kSin,
  kCos,
  kTan,
  kAsin,
  kAcos,
  kAtan,
  kSqrt,
  kHypot,
  kLinear,
};

/// The moment at which an expression is evaluated.
struct Moment {
  double time = 0;
  double frame = 0;
};

/// An expression that is too large or nested too deeply to be kept.
struct ExpressionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Expression {
 public:
  /// Limits of one expression, with the symbols it uses written out: each evaluation takes bounded time, and
  /// the text can be parsed again.
  static constexpr int kMaxNodes = 100000;
  static constexpr int kMaxNesting = 2000;

  // NOLINTNEXTLINE(google-explicit-constructor): numbers are expressions
  Expression(double constant = 0) : constant_(constant) {}
  static Expression time();
  static Expression frame();
  /// An operation over its operands (unary operations take one, kLinear four). Folded to a constant when all
  /// operands are constant and the operation is not kLinear. kRemainder: both truncated to int, C remainder;
  /// a constant divisor of zero must be refused by the caller before (at run time it gives NaN). kPower is
  /// fn::pow. Throws ExpressionError beyond the limits.
  static Expression apply(Operation op, std::array<Expression, 4> operands);

  bool constant() const { return !node_; }
  /// The value; for a constant whatever the moment.
  double evaluate(const Moment& moment) const;
  /// Contains the value at every time of the interval where there is one (NaN is no value).
  Interval evaluate(const Interval& time, double frame) const;
  /// Canonical text that parses to the same tree (parenthesised when not constant; the shortest decimals that
  /// round-trip).
  std::string text() const;

 private:
  struct Node;
  double constant_ = 0;
  std::shared_ptr<const Node> node_;
};

}  // namespace rayshade
