// SPDX-License-Identifier: MIT
// See condition.h. Precedence climbing; the operands of an operator that is not needed (the right side of &&
// and ||, the branch not taken of ?:) are read, but a division by zero in them is no mistake.
#include "rayshade/lang/condition.h"

#include <fmt/format.h>

#include <limits>

#include "rayshade/lang/macro.h"

namespace rayshade::lang {
namespace {

constexpr int kMostNesting = 500;

struct Operator {
  std::string_view text;
  int precedence;
};
// Longer spellings first.
constexpr Operator kOperators[] = {{"||", 1}, {"&&", 2}, {"==", 6}, {"!=", 6}, {"<=", 7}, {">=", 7},
                                   {"<<", 8}, {">>", 8}, {"|", 3},  {"^", 4},  {"&", 5},  {"<", 7},
                                   {">", 7},  {"+", 9},  {"-", 9},  {"*", 10}, {"/", 10}, {"%", 10}};

class Evaluator {
 public:
  explicit Evaluator(std::string_view text) : text_(text) {}

  std::int64_t run() {
    const std::int64_t value = conditional(true);
    skip();
    if (!text_.empty()) fail(fmt::format("unexpected '{}' in this condition", text_.substr(0, 20)));
    return value;
  }

 private:
  using Unsigned = std::uint64_t;

  struct Level {
    int& depth;
    explicit Level(int& d) : depth(d) {
      if (++depth > kMostNesting) throw ConditionError("this condition is nested too deeply");
    }
    ~Level() { --depth; }
  };

  [[noreturn]] static void fail(const std::string& text) { throw ConditionError(text); }
  void skip() { text_ = trim(text_); }
  bool accept(std::string_view token) {
    skip();
    if (text_.substr(0, token.size()) != token) return false;
    text_.remove_prefix(token.size());
    return true;
  }

  std::int64_t conditional(bool live) {
    const Level level(depth_);
    const std::int64_t test = binary(1, live);
    if (!accept("?")) return test;
    const std::int64_t yes = conditional(live && test != 0);
    if (!accept(":")) fail("'?' without ':' in this condition");
    const std::int64_t no = conditional(live && test == 0);
    return test != 0 ? yes : no;
  }

  const Operator* next_operator() {
    skip();
    for (const Operator& op : kOperators) {
      if (text_.substr(0, op.text.size()) == op.text) return &op;
    }
    return nullptr;
  }

  std::int64_t binary(int lowest, bool live) {
    const Level level(depth_);
    std::int64_t left = unary(live);
    for (const Operator* op = next_operator(); op && op->precedence >= lowest; op = next_operator()) {
      text_.remove_prefix(op->text.size());
      const bool settled = (op->precedence == 1 && left != 0) || (op->precedence == 2 && left == 0);
      const std::int64_t right = binary(op->precedence + 1, live && !settled);
      left = apply(op->text, left, right, live && !settled);
    }
    return left;
  }

  static std::int64_t apply(std::string_view op, std::int64_t a, std::int64_t b, bool live) {
    const auto ua = static_cast<Unsigned>(a), ub = static_cast<Unsigned>(b);
    if (op == "||") return a != 0 || b != 0;
    if (op == "&&") return a != 0 && b != 0;
    if (op == "==") return a == b;
    if (op == "!=") return a != b;
    if (op == "<=") return a <= b;
    if (op == ">=") return a >= b;
    if (op == "<") return a < b;
    if (op == ">") return a > b;
    if (op == "|") return a | b;
    if (op == "^") return a ^ b;
    if (op == "&") return a & b;
    if (op == "<<") return static_cast<std::int64_t>(ua << (ub & 63));
    if (op == ">>") return a >> (ub & 63);
    if (op == "+") return static_cast<std::int64_t>(ua + ub);
    if (op == "-") return static_cast<std::int64_t>(ua - ub);
    if (op == "*") return static_cast<std::int64_t>(ua * ub);
    if (b == 0) {
      if (live) fail("division by zero in this condition");
      return 0;
    }
    if (b == -1)
      return op == "/" ? static_cast<std::int64_t>(0 - ua) : 0;  // the one quotient that can overflow
    return op == "/" ? a / b : a % b;
  }

  std::int64_t unary(bool live) {
    const Level level(depth_);
    skip();
    if (accept("!")) return unary(live) == 0;
    if (accept("~")) return ~unary(live);
    if (accept("-")) return static_cast<std::int64_t>(0 - static_cast<Unsigned>(unary(live)));
    if (accept("+")) return unary(live);
    if (accept("(")) {
      const std::int64_t value = conditional(live);
      if (!accept(")")) fail("')' is missing in this condition");
      return value;
    }
    if (const std::size_t n = number_length(text_)) return number(n);
    if (const std::size_t n = identifier_length(text_)) {
      text_.remove_prefix(n);
      return 0;
    }
    if (text_.empty()) fail("a value is missing in this condition");
    fail(fmt::format("unexpected '{}' in this condition", text_.substr(0, 20)));
  }

  std::int64_t number(std::size_t n) {
    const std::string_view token = text_.substr(0, n);
    text_.remove_prefix(n);
    std::string_view digits = token;
    while (!digits.empty() && std::string_view("uUlL").find(digits.back()) != std::string_view::npos)
      digits.remove_suffix(1);
    Unsigned base = 10;
    if (digits.size() > 1 && digits[0] == '0') {
      const bool hex = digits[1] == 'x' || digits[1] == 'X';
      base = hex ? 16 : 8;
      digits.remove_prefix(hex ? 2 : 1);
    }
    Unsigned value = 0;
    if (digits.empty()) fail(fmt::format("'{}' is not an integer", token));
    for (const char c : digits) {
      const Unsigned digit = c >= '0' && c <= '9'   ? static_cast<Unsigned>(c - '0')
                             : c >= 'a' && c <= 'f' ? static_cast<Unsigned>(c - 'a' + 10)
                             : c >= 'A' && c <= 'F' ? static_cast<Unsigned>(c - 'A' + 10)
                                                    : 99;
      if (digit >= base) fail(fmt::format("'{}' is not an integer", token));
      value = value * base + digit;
    }
    return static_cast<std::int64_t>(value);
  }

  std::string_view text_;
  int depth_ = 0;
};

}  // namespace

std::int64_t evaluate_condition(std::string_view text) { return Evaluator(text).run(); }

}  // namespace rayshade::lang
