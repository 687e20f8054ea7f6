// SPDX-License-Identifier: MIT
// Trees of operations. Chains of 100,000 operations are legal, so everything that walks a tree does it with a
// stack of its own once the tree is deeper than kRecursionLimit; below that, plain recursion is faster and is
// the common case.
#include "rayshade/scene/expression.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "rayshade/math/functions.h"
#include "rayshade/math/vec.h"
#include "rayshade/scene/number_text.h"

namespace rayshade {
namespace {

constexpr int kRecursionLimit = 64;

int operand_count(Operation op) {
  switch (op) {
    case Operation::kConstant:
    case Operation::kTime:
    case Operation::kFrame:
      return 0;
    case Operation::kAdd:
    case Operation::kSubtract:
    case Operation::kMultiply:
    case Operation::kDivide:
    case Operation::kRemainder:
    case Operation::kPower:
    case Operation::kHypot:
      return 2;
    case Operation::kNegate:
    case Operation::kSin:
    case Operation::kCos:
    case Operation::kTan:
    case Operation::kAsin:
    case Operation::kAcos:
    case Operation::kAtan:
    case Operation::kSqrt:
      return 1;
    case Operation::kLinear:
      return 4;
  }
  return 0;
}

/// C remainder of the operands truncated to integers. Numbers beyond the range of int go on in doubles, where
/// the remainder is exact too; no value (NaN) for a divisor that truncates to zero and for operands that are
/// not finite.
double integer_remainder(double a, double b) {
  const double divisor = std::trunc(b);
  if (divisor == 0 || !std::isfinite(a) || !std::isfinite(b)) return std::numeric_limits<double>::quiet_NaN();
  return std::fmod(std::trunc(a), divisor) + 0.0;  // + 0.0: integers have no negative zero
}

/// language.md 7.
double linear(double time, double t0, double v0, double t1, double v1) {
  if (time < t0) return v0;
  if (time > t1) return v1;
  if (std::fabs(t1 - t0) < kEpsilon) return v0;
  return v0 + (v1 - v0) * (time - t0) / (t1 - t0);
}

/// The range of linear(). Between t0 and t1 the value lies between v0 and v1 but for rounding, whatever
/// varies.
Interval linear(const Interval& time, const Interval& t0, const Interval& v0, const Interval& t1,
                const Interval& v1) {
  const bool before = time.lo<t0.hi, after = time.hi> t1.lo;
  const double first = std::max(time.lo, t0.lo), last = std::min(time.hi, t1.hi);
  Interval out{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  if (before) out = join(out, v0);
  if (after) out = join(out, v1);
  if (!(first > last)) {
    const Interval hull = join(v0, v1);
    const double size = std::max(std::fabs(hull.lo), std::fabs(hull.hi));
    // The slope and its products must not overflow; nothing sensible moves that far.
    if (!(size < 1e100 && std::fabs(first) < 1e100 && std::fabs(last) < 1e100)) return Interval::everything();
    if (t0.is_point() && t1.is_point() && v0.is_point() && v1.is_point()) {
      // Every operation of the formula is monotone in time, rounding included.
      const double a = linear(first, t0.lo, v0.lo, t1.lo, v1.lo),
                   b = linear(last, t0.lo, v0.lo, t1.lo, v1.lo);
      out = join(out, {std::min(a, b), std::max(a, b)});
    } else {
      const double rounding = 8 * std::numeric_limits<double>::epsilon() * size;
      Interval middle{hull.lo - rounding, hull.hi + rounding};
      const Interval span = t1 - t0;
      if (span.lo >= kEpsilon) {
        const Interval value = v0 + (v1 - v0) * (Interval{first, last} - t0) / span;
        middle = {std::max(middle.lo, value.lo), std::min(middle.hi, value.hi)};
      }
      out = join(out, middle);
    }
  }
  return out.lo <= out.hi ? out : Interval::everything();
}

/// The moment of an evaluation over doubles, and the arithmetic of both kinds of evaluation.
struct Pointwise {
  using Value = double;
  const Moment& moment;
  double constant(double v) const { return v; }
  double time() const { return moment.time; }
  double frame() const { return moment.frame; }
  static double remainder(double a, double b) { return integer_remainder(a, b); }
  static double sin(double a) { return fn::sin(a); }
  static double cos(double a) { return fn::cos(a); }
  static double tan(double a) { return fn::tan(a); }
  static double asin(double a) { return fn::asin(a); }
  static double acos(double a) { return fn::acos(a); }
  static double atan(double a) { return fn::atan(a); }
  static double sqrt(double a) { return std::sqrt(a); }
  static double hypot(double a, double b) { return fn::hypot(a, b); }
  static double pow(double a, double b) { return fn::pow(a, b); }
};

struct Rangewise {
  using Value = Interval;
  const Interval& time_range;
  double frame_number;
  Interval constant(double v) const { return std::isnan(v) ? Interval::everything() : Interval::point(v); }
  Interval time() const { return time_range; }
  Interval frame() const { return Interval::point(frame_number); }
  static Interval remainder(const Interval& a, const Interval& b) { return integer_remainder(a, b); }
  static Interval sin(const Interval& a) { return rayshade::sin(a); }
  static Interval cos(const Interval& a) { return rayshade::cos(a); }
  static Interval tan(const Interval& a) { return rayshade::tan(a); }
  static Interval asin(const Interval& a) { return rayshade::asin(a); }
  static Interval acos(const Interval& a) { return rayshade::acos(a); }
  static Interval atan(const Interval& a) { return rayshade::atan(a); }
  static Interval sqrt(const Interval& a) { return rayshade::sqrt(a); }
  static Interval hypot(const Interval& a, const Interval& b) { return rayshade::hypot(a, b); }
  static Interval pow(const Interval& a, const Interval& b) { return rayshade::pow(a, b); }
};

template <class Arithmetic>
typename Arithmetic::Value combine(const Arithmetic& in, Operation op, const typename Arithmetic::Value* v) {
  switch (op) {
    case Operation::kConstant:
      break;  // constants carry no node
    case Operation::kTime:
      return in.time();
    case Operation::kFrame:
      return in.frame();
    case Operation::kAdd:
      return v[0] + v[1];
    case Operation::kSubtract:
      return v[0] - v[1];
    case Operation::kMultiply:
      return v[0] * v[1];
    case Operation::kDivide:
      return v[0] / v[1];
    case Operation::kRemainder:
      return in.remainder(v[0], v[1]);
    case Operation::kPower:
      return in.pow(v[0], v[1]);
    case Operation::kNegate:
      return -v[0];
    case Operation::kSin:
      return in.sin(v[0]);
    case Operation::kCos:
      return in.cos(v[0]);
    case Operation::kTan:
      return in.tan(v[0]);
    case Operation::kAsin:
      return in.asin(v[0]);
    case Operation::kAcos:
      return in.acos(v[0]);
    case Operation::kAtan:
      return in.atan(v[0]);
    case Operation::kSqrt:
      return in.sqrt(v[0]);
    case Operation::kHypot:
      return in.hypot(v[0], v[1]);
    case Operation::kLinear:
      return linear(in.time(), v[0], v[1], v[2], v[3]);
  }
  return in.constant(0);
}

/// How tightly an operator binds in text; operands of a looser one need parentheses.
enum Precedence { kSum, kProduct, kUnary, kRaise, kPrimary };

Precedence precedence(Operation op) {
  switch (op) {
    case Operation::kAdd:
    case Operation::kSubtract:
      return kSum;
    case Operation::kMultiply:
    case Operation::kDivide:
    case Operation::kRemainder:
      return kProduct;
    case Operation::kNegate:
      return kUnary;
    case Operation::kPower:
      return kRaise;
    default:
      return kPrimary;
  }
}

const char* spelling(Operation op) {
  switch (op) {
    case Operation::kConstant:
      return "";
    case Operation::kTime:
      return "time";
    case Operation::kFrame:
      return "frame";
    case Operation::kAdd:
      return " + ";
    case Operation::kSubtract:
      return " - ";
    case Operation::kMultiply:
      return " * ";
    case Operation::kDivide:
      return " / ";
    case Operation::kRemainder:
      return " % ";
    case Operation::kPower:
      return " ^ ";
    case Operation::kNegate:
      return "-";
    case Operation::kSin:
      return "sin(";
    case Operation::kCos:
      return "cos(";
    case Operation::kTan:
      return "tan(";
    case Operation::kAsin:
      return "asin(";
    case Operation::kAcos:
      return "acos(";
    case Operation::kAtan:
      return "atan(";
    case Operation::kSqrt:
      return "sqrt(";
    case Operation::kHypot:
      return "hypot(";
    case Operation::kLinear:
      return "linear(";
  }
  return "";
}

/// The loosest operator that operand `index` of `op` may have without parentheses.
Precedence loosest(Operation op, int index) {
  switch (precedence(op)) {
    case kSum:
      return index == 0 ? kSum : kProduct;
    case kProduct:
      return index == 0 ? kProduct : kUnary;
    case kUnary:
      return kUnary;
    case kRaise:
      return index == 0 ? kPrimary : kRaise;
    case kPrimary:
      return kSum;  // arguments of functions stand between commas
  }
  return kPrimary;
}

}  // namespace

struct Expression::Node {
  Operation op;
  int depth = 1;    ///< levels of the tree
  int nodes = 1;    ///< operations that vary, counted as often as they are used
  int nesting = 0;  ///< levels of its text that a parser must stack
  std::array<Expression, 4> operands;

  explicit Node(Operation operation) : op(operation) {}
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  ~Node();

  template <class Arithmetic>
  static typename Arithmetic::Value evaluate(const Expression& root, const Arithmetic& in);
  template <class Arithmetic>
  static typename Arithmetic::Value evaluate_deep(const Expression& root, const Arithmetic& in);
  static Precedence precedence_of(const Expression& e);
};

/// Takes a deep tree apart level by level, so that its destruction does not recurse.
Expression::Node::~Node() {
  if (depth <= kRecursionLimit) return;
  std::vector<std::shared_ptr<const Node>> pending;
  const auto take = [&pending](std::array<Expression, 4>& from) {
    for (Expression& operand : from) {
      if (operand.node_) pending.push_back(std::move(operand.node_));
    }
  };
  take(operands);
  while (!pending.empty()) {
    const std::shared_ptr<const Node> node = std::move(pending.back());
    pending.pop_back();
    // The last owner may empty the node: nobody else sees it any more, and all nodes are made non-const.
    if (node.use_count() == 1) take(const_cast<Node&>(*node).operands);
  }
}

template <class Arithmetic>
typename Arithmetic::Value Expression::Node::evaluate(const Expression& root, const Arithmetic& in) {
  if (!root.node_) return in.constant(root.constant_);
  const Node& node = *root.node_;
  if (node.depth > kRecursionLimit) return evaluate_deep(root, in);
  typename Arithmetic::Value values[4];
  const int count = operand_count(node.op);
  for (int i = 0; i < count; ++i) values[i] = evaluate(node.operands[static_cast<std::size_t>(i)], in);
  return combine(in, node.op, values);
}

template <class Arithmetic>
typename Arithmetic::Value Expression::Node::evaluate_deep(const Expression& root, const Arithmetic& in) {
  struct Visit {
    const Node* node;
    int next;
  };
  std::vector<Visit> visits{{root.node_.get(), 0}};
  std::vector<typename Arithmetic::Value> values;
  while (!visits.empty()) {
    Visit& top = visits.back();
    const int count = operand_count(top.node->op);
    if (top.next < count) {
      const Expression& operand = top.node->operands[static_cast<std::size_t>(top.next++)];
      if (operand.node_ && operand.node_->depth > kRecursionLimit) {
        visits.push_back({operand.node_.get(), 0});
      } else {
        values.push_back(evaluate(operand, in));
      }
      continue;
    }
    const std::size_t first = values.size() - static_cast<std::size_t>(count);
    const typename Arithmetic::Value value = combine(in, top.node->op, values.data() + first);
    values.resize(first);
    values.push_back(value);
    visits.pop_back();
  }
  return values.back();
}

/// Numbers below zero print with a sign and infinities as a quotient: they bind like those.
Precedence Expression::Node::precedence_of(const Expression& e) {
  if (e.node_) return precedence(e.node_->op);
  if (!std::isfinite(e.constant_)) return kProduct;
  return std::signbit(e.constant_) ? kUnary : kPrimary;
}

Expression Expression::time() {
  Expression out;
  out.node_ = std::make_shared<Node>(Operation::kTime);
  return out;
}

Expression Expression::frame() {
  Expression out;
  out.node_ = std::make_shared<Node>(Operation::kFrame);
  return out;
}

Expression Expression::apply(Operation op, std::array<Expression, 4> operands) {
  const int count = operand_count(op);
  if (op == Operation::kTime) return time();
  if (op == Operation::kFrame) return frame();
  if (op == Operation::kConstant) return operands[0];
  const bool fold = op != Operation::kLinear && std::all_of(operands.begin(), operands.begin() + count,
                                                            [](const Expression& e) { return e.constant(); });
  if (fold) {
    double values[4];
    for (int i = 0; i < count; ++i) values[i] = operands[static_cast<std::size_t>(i)].constant_;
    const Moment none;
    return combine(Pointwise{none}, op, values);
  }
  auto node = std::make_shared<Node>(op);
  int nodes = 1;
  for (int i = 0; i < count; ++i) {
    Expression& operand = operands[static_cast<std::size_t>(i)];
    // The left end of a chain a + b + c stands at the same level of the text; everything else is one level
    // in.
    const bool inner = i > 0 || Node::precedence_of(operand) < loosest(op, i) || precedence(op) == kPrimary ||
                       precedence(op) == kUnary;
    if (operand.node_) {
      node->depth = std::max(node->depth, operand.node_->depth + 1);
      node->nesting = std::max(node->nesting, operand.node_->nesting + inner);
      nodes += operand.node_->nodes;
    }
    node->operands[static_cast<std::size_t>(i)] = std::move(operand);
  }
  node->nodes = nodes;
  if (nodes > kMaxNodes) throw ExpressionError("expression has too many operations");
  if (node->nesting > kMaxNesting) throw ExpressionError("expression is nested too deeply");
  Expression out;
  out.node_ = std::move(node);
  return out;
}

double Expression::evaluate(const Moment& moment) const {
  return node_ ? Node::evaluate(*this, Pointwise{moment}) : constant_;
}

Interval Expression::evaluate(const Interval& time, double frame) const {
  return Node::evaluate(*this, Rangewise{time, frame});
}

std::string Expression::text() const {
  // A list of things still to write: pieces of text, and operands with the loosest operator that may stand
  // bare.
  struct Item {
    const Expression* expression;  ///< nullptr: a piece of text
    Precedence bare;
    const char* piece;
  };
  std::string out;
  std::vector<Item> items;
  const bool outer = node_ || !std::isfinite(constant_);
  if (outer) items.push_back({nullptr, kSum, ")"});
  items.push_back({this, kSum, nullptr});
  if (outer) items.push_back({nullptr, kSum, "("});
  while (!items.empty()) {
    const Item item = items.back();
    items.pop_back();
    if (!item.expression) {
      out += item.piece;
      continue;
    }
    const bool parentheses = Node::precedence_of(*item.expression) < item.bare;
    if (parentheses) out += '(';
    if (parentheses) items.push_back({nullptr, kSum, ")"});
    if (item.expression->constant()) {
      append_number(out, item.expression->constant_, /*bare=*/true);
      continue;
    }
    const Node& node = *item.expression->node_;
    const int count = operand_count(node.op);
    const bool infix = count == 2 && precedence(node.op) != kPrimary;
    if (!infix) out += spelling(node.op);
    if (!infix && precedence(node.op) == kPrimary && count > 0) items.push_back({nullptr, kSum, ")"});
    for (int i = count; i-- > 0;) {
      items.push_back({&node.operands[static_cast<std::size_t>(i)], loosest(node.op, i), nullptr});
      if (i > 0) items.push_back({nullptr, kSum, infix ? spelling(node.op) : ", "});
    }
  }
  return out;
}

}  // namespace rayshade
