// SPDX-License-Identifier: MIT
// Values, ranges, limits and text of time-varying expressions.
#include "rayshade/scene/expression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

Expression op(Operation operation, Expression a, Expression b = 0, Expression c = 0, Expression d = 0) {
  return Expression::apply(operation, {std::move(a), std::move(b), std::move(c), std::move(d)});
}

Expression time() { return Expression::time(); }

double at(const Expression& e, double time_value, double frame = 0) {
  return e.evaluate(Moment{time_value, frame});
}

TEST(ExpressionTest, ConstantsFold) {
  EXPECT_TRUE(op(Operation::kAdd, 1, 2).constant());
  EXPECT_EQ(at(op(Operation::kPower, 2, op(Operation::kPower, 3, 2)), 0), 512);
  EXPECT_EQ(at(op(Operation::kNegate, op(Operation::kPower, 2, 2)), 0), -4);
  EXPECT_EQ(at(op(Operation::kDivide, 5, 0), 0), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(at(op(Operation::kSqrt, -1), 0)));
  EXPECT_EQ(at(op(Operation::kHypot, 3, 4), 0), 5);
}

TEST(ExpressionTest, WhatMentionsTimeVaries) {
  EXPECT_FALSE(op(Operation::kMultiply, 0, time()).constant());
  EXPECT_FALSE(Expression::frame().constant());
  EXPECT_FALSE(op(Operation::kLinear, 0, 1, 2, 3).constant());
  EXPECT_EQ(at(op(Operation::kMultiply, op(Operation::kAdd, time(), 1), Expression::frame()), 2, 5), 15);
}

TEST(ExpressionTest, RemainderIsThatOfIntegers) {
  const auto remainder = [](double a, double b) { return at(op(Operation::kRemainder, a, b), 0); };
  EXPECT_EQ(remainder(-7, 3), -1);
  EXPECT_EQ(remainder(7, -3), 1);
  EXPECT_EQ(remainder(7.9, 3.9), 1);
  EXPECT_EQ(remainder(-2, 3), -2);
  EXPECT_FALSE(std::signbit(remainder(-3, 3)));
  // No undefined behaviour where C has it: beyond int the remainder is that of larger integers.
  EXPECT_EQ(remainder(1e15 + 1, 10), 1);
  EXPECT_EQ(remainder(-2147483648.0, -1), 0);
  EXPECT_EQ(remainder(7, 1e300), 7);
  EXPECT_TRUE(std::isnan(remainder(std::nan(""), 3)));
  EXPECT_TRUE(std::isnan(remainder(3, std::nan(""))));
  EXPECT_TRUE(std::isnan(remainder(std::numeric_limits<double>::infinity(), 3)));
  EXPECT_TRUE(std::isnan(at(op(Operation::kRemainder, 5, time()), 0.5)));
  EXPECT_EQ(at(op(Operation::kRemainder, 5, time()), 3.5), 2);
}

TEST(ExpressionTest, LinearRunsBetweenItsEnds) {
  const Expression e = op(Operation::kLinear, 1, 10, 3, 20);
  EXPECT_EQ(at(e, 0.5), 10);
  EXPECT_EQ(at(e, 1), 10);
  EXPECT_EQ(at(e, 2), 15);
  EXPECT_EQ(at(e, 3), 20);
  EXPECT_EQ(at(e, 4), 20);
  // language.md 7: times that are equal give the first value at that time, the second one after it.
  const Expression step = op(Operation::kLinear, 1, 10, 1, 20);
  EXPECT_EQ(at(step, 0.9), 10);
  EXPECT_EQ(at(step, 1), 10);
  EXPECT_EQ(at(step, 1.1), 20);
  // Arguments may vary themselves.
  EXPECT_EQ(at(op(Operation::kLinear, 0, time(), 2, op(Operation::kMultiply, time(), 3)), 1), 2);
}

TEST(ExpressionTest, TextParsesToTheSameTree) {
  // Precedences of language.md 3.2; operators stand between blanks because a-b and a/b are single words.
  EXPECT_EQ(Expression(2.5).text(), "2.5");
  EXPECT_EQ(Expression(-2).text(), "-2");
  EXPECT_EQ(Expression(0.1).text(), "0.1");
  EXPECT_EQ(Expression(1e300).text(), "1e+300");
  EXPECT_EQ(time().text(), "(time)");
  EXPECT_EQ(op(Operation::kSin, time()).text(), "(sin(time))");
  EXPECT_EQ(op(Operation::kLinear, 0, -1, time(), op(Operation::kAdd, time(), 1)).text(),
            "(linear(0, -1, time, time + 1))");
  const Expression sum = op(Operation::kSubtract, op(Operation::kAdd, time(), 1), Expression::frame());
  EXPECT_EQ(sum.text(), "(time + 1 - frame)");
  EXPECT_EQ(op(Operation::kSubtract, 1, sum).text(), "(1 - (time + 1 - frame))");
  EXPECT_EQ(op(Operation::kMultiply, sum, 2).text(), "((time + 1 - frame) * 2)");
  EXPECT_EQ(op(Operation::kDivide, 2, op(Operation::kMultiply, time(), 3)).text(), "(2 / (time * 3))");
  EXPECT_EQ(op(Operation::kRemainder, op(Operation::kMultiply, time(), 3), 2).text(), "(time * 3 % 2)");
  EXPECT_EQ(op(Operation::kNegate, op(Operation::kPower, time(), 2)).text(), "(-time ^ 2)");
  EXPECT_EQ(op(Operation::kPower, op(Operation::kNegate, time()), 2).text(), "((-time) ^ 2)");
  EXPECT_EQ(op(Operation::kPower, -2, time()).text(), "((-2) ^ time)");
  EXPECT_EQ(op(Operation::kPower, op(Operation::kPower, time(), 2), 3).text(), "((time ^ 2) ^ 3)");
  EXPECT_EQ(op(Operation::kPower, time(), op(Operation::kPower, 3, time())).text(), "(time ^ 3 ^ time)");
  EXPECT_EQ(op(Operation::kNegate, op(Operation::kAdd, time(), 1)).text(), "(-(time + 1))");
  EXPECT_EQ(op(Operation::kAdd, time(), op(Operation::kNegate, time())).text(), "(time + -time)");
}

TEST(ExpressionTest, TextHasNoInfinities) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Expression(inf).text(), "(1 / 0)");
  EXPECT_EQ(Expression(-inf).text(), "(-1 / 0)");
  EXPECT_EQ(Expression(std::nan("")).text(), "(0 / 0)");
  EXPECT_EQ(op(Operation::kPower, time(), inf).text(), "(time ^ (1 / 0))");
  EXPECT_EQ(op(Operation::kAdd, time(), inf).text(), "(time + 1 / 0)");
}

TEST(ExpressionTest, LongChainsNeitherOverflowTheStackNorLoseValues) {
  Expression sum = time();
  for (int i = 1; i < Expression::kMaxNodes; ++i) sum = op(Operation::kAdd, std::move(sum), 1);
  EXPECT_EQ(at(sum, 0.5), Expression::kMaxNodes - 0.5);
  const Interval range = sum.evaluate(Interval{0, 1}, 0);
  EXPECT_TRUE(range.contains(Expression::kMaxNodes - 0.5));
  EXPECT_NEAR(range.hi, Expression::kMaxNodes, 1e-4);
  EXPECT_EQ(sum.text().size(), std::string("(time)").size() + 4 * (Expression::kMaxNodes - 1));
  EXPECT_THROW(op(Operation::kAdd, sum, 1), ExpressionError);
  // Destruction happens here, with an owner in the middle that outlives the rest.
}

TEST(ExpressionTest, SharedDeepTreesSurviveTheirOwners) {
  Expression kept;
  {
    Expression chain = time();
    for (int i = 0; i < 50000; ++i) {
      chain = op(Operation::kAdd, std::move(chain), 1);
      if (i == 25000) kept = chain;
    }
    EXPECT_EQ(at(chain, 0), 50000);
  }
  EXPECT_EQ(at(kept, 0), 25001);
}

TEST(ExpressionTest, NestingIsLimited) {
  Expression nested = time();
  for (int i = 0; i < Expression::kMaxNesting; ++i) nested = op(Operation::kSubtract, 1, std::move(nested));
  EXPECT_EQ(at(nested, 0.25), 0.25);
  EXPECT_THROW(op(Operation::kSubtract, 1, nested), ExpressionError);
  EXPECT_NO_THROW(op(Operation::kSubtract, nested, 1));
}

TEST(ExpressionTest, DoublingIsLimited) {
  // define b (a + a), define c (b + b) ...: small in memory, without end to evaluate.
  Expression e = time();
  const auto grow = [&] {
    for (int i = 0; i < 100; ++i) e = op(Operation::kAdd, e, e);
  };
  EXPECT_THROW(grow(), ExpressionError);
}

/// Random trees over all operations.
class Trees {
 public:
  explicit Trees(unsigned seed) : random_(seed) {}

  Expression tree(int depth) {
    const auto kind = random_() % 10;
    if (depth == 0 || kind == 0)
      return kind < 4 ? Expression(uniform(-5, 5)) : kind < 5 ? Expression::frame() : time();
    if (kind == 1) return std::round(uniform(-4, 4));
    static constexpr Operation kAll[] = {Operation::kAdd,    Operation::kSubtract,  Operation::kMultiply,
                                         Operation::kDivide, Operation::kRemainder, Operation::kPower,
                                         Operation::kNegate, Operation::kSin,       Operation::kCos,
                                         Operation::kTan,    Operation::kAsin,      Operation::kAcos,
                                         Operation::kAtan,   Operation::kSqrt,      Operation::kHypot,
                                         Operation::kLinear, Operation::kLinear};
    const Operation chosen = kAll[random_() % std::size(kAll)];
    std::array<Expression, 4> operands;
    for (Expression& operand : operands) operand = tree(depth - 1);
    if (chosen == Operation::kLinear && random_() % 2 == 0) {
      for (Expression& operand : operands) operand = uniform(-2, 4);
    }
    return Expression::apply(chosen, operands);
  }

  double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }

 private:
  std::mt19937 random_;
};

TEST(ExpressionTest, RangesContainTheirValues) {
  const unsigned seed = 31337;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Trees trees(seed);
  int informative = 0;
  for (int i = 0; i < 20000; ++i) {
    const Expression e = trees.tree(1 + i % 4);
    const double a = trees.uniform(-3, 5), width = i % 3 == 0 ? 1e-3 : trees.uniform(0, 3);
    const Interval range = e.evaluate(Interval{a, a + width}, 3);
    ASSERT_LE(range.lo, range.hi);
    informative += std::isfinite(range.lo) && std::isfinite(range.hi);
    for (int j = 0; j <= 20; ++j) {
      const double t = j == 0 ? a : j == 1 ? a + width : a + width * trees.uniform(0, 1);
      const double value = at(e, std::min(t, a + width), 3);
      if (std::isnan(value)) continue;
      ASSERT_TRUE(range.contains(value)) << e.text() << " at " << t << " is " << value << ", not in ["
                                         << range.lo << ", " << range.hi << "]";
    }
  }
  EXPECT_GT(informative, 10000);
}

TEST(ExpressionTest, CommonRangesAreTight) {
  const auto expect_range = [](const Expression& e, const Interval& when, double lo, double hi) {
    const Interval range = e.evaluate(when, 0);
    EXPECT_NEAR(range.lo, lo, 1e-12) << e.text();
    EXPECT_NEAR(range.hi, hi, 1e-12) << e.text();
  };
  expect_range(op(Operation::kLinear, 0, -1, 2, 5), {0, 1}, -1, 2);
  expect_range(op(Operation::kLinear, 0, -1, 2, 5), {-1, 7}, -1, 5);
  expect_range(op(Operation::kLinear, 1, 0, 1, 5), {0, 1}, 0, 0);
  expect_range(op(Operation::kMultiply, time(), 360), {0.25, 0.5}, 90, 180);
  expect_range(op(Operation::kSin, op(Operation::kMultiply, time(), fn::kPi)), {0, 1}, 0, 1);
  // Ends that vary, but never leave [0, 1].
  expect_range(op(Operation::kLinear, 0, op(Operation::kSin, time()), 1, 1), {0, 1}, 0, 1);
}

}  // namespace
}  // namespace rayshade
