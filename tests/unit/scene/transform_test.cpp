// SPDX-License-Identifier: MIT
// Transform lists at a moment, and motion bounds against many sampled moments.
#include "rayshade/scene/transform.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

Expression time() { return Expression::time(); }

Expression times(Expression a, Expression b) {
  return Expression::apply(Operation::kMultiply, {std::move(a), std::move(b)});
}

AnimatedStep step(StepKind kind, std::vector<Expression> arguments) {
  AnimatedStep out;
  out.kind = kind;
  for (std::size_t i = 0; i < arguments.size(); ++i) out.arguments[i] = arguments[i];
  out.location.line = 12;
  return out;
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(TransformListTest, ConstantsFoldInTheOrderWritten) {
  TransformList list;
  EXPECT_TRUE(list.empty());
  list.append(translation({2, 0, 0}));
  list.append(rotation_degrees({0, 1, 0}, 90));
  EXPECT_EQ(list.elements().size(), 1u);
  EXPECT_FALSE(list.animated());
  expect_near(list.at({}).point({0, 0, 0}), {0, 0, -2});
}

TEST(TransformListTest, AnimatedStepsStaySeparate) {
  TransformList list;
  list.append(translation({1, 0, 0}));
  list.append(step(StepKind::kRotate, {0, 0, 1, times(time(), 90)}));
  list.append(translation({0, 0, 5}));
  list.append(scaling({2, 2, 2}));
  EXPECT_EQ(list.elements().size(), 3u);
  EXPECT_TRUE(list.animated());
  expect_near(list.at({0, 0}).point({}), {2, 0, 10});
  expect_near(list.at({1, 0}).point({}), {0, 2, 10});

  TransformList outer;
  outer.append(translation({0, 1, 0}));
  list.append(outer);  // folds into the constant end
  EXPECT_EQ(list.elements().size(), 3u);
  expect_near(list.at({1, 0}).point({}), {0, 3, 10});
  list.append(list);
  EXPECT_EQ(list.elements().size(), 5u);
}

TEST(TransformListTest, EachKindOfStepMoves) {
  TransformList list;
  list.append(step(StepKind::kScale, {time(), 1, -1}));
  expect_near(list.at({3, 0}).point({1, 1, 1}), {3, 1, -1});
  TransformList matrix;
  matrix.append(step(StepKind::kMatrix, {0, 1, 0, -1, 0, 0, 0, 0, time(), 7, 8, Expression::frame()}));
  expect_near(matrix.at({2, 9}).point({1, 2, 3}), {5, 9, 15});
}

TEST(TransformListTest, DegenerateMotionNamesPlaceAndTime) {
  const auto expect_error = [](AnimatedStep bad, double when, const std::string& part) {
    TransformList list;
    list.append(std::move(bad));
    EXPECT_NO_THROW(list.at({when + 1, 0}));
    try {
      list.at({when, 0});
      FAIL() << "no error";
    } catch (const MotionError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
      EXPECT_EQ(error.location.line, 12u);
      EXPECT_EQ(error.time, when);
    }
  };
  expect_error(step(StepKind::kScale, {1, time(), 1}), 0, "degenerate scale 1 0 1 at time 0");
  expect_error(step(StepKind::kMatrix, {1, 0, 0, 0, 1, 0, 0, time(), time()}), 0,
               "singular matrix at time 0");
  const Expression pole = Expression::apply(Operation::kDivide, {Expression(1), time()});
  expect_error(step(StepKind::kTranslate, {pole, 0, 0}), 0, "no finite value at time 0");
  const Expression small = Expression::apply(Operation::kAdd, {Expression(9e-6), time()});
  expect_error(step(StepKind::kScale, {1, 1, small}), 0, "degenerate scale 1 1 9e-06 at time 0");
  // A turn about nothing turns nothing.
  TransformList list;
  list.append(step(StepKind::kScale, {time(), time(), time()}));
  EXPECT_NO_THROW(list.at({1e-5, 0}));
  TransformList still;
  still.append(step(StepKind::kRotate, {time(), 0, 0, 90}));
  EXPECT_EQ(still.at({0, 0}), Affine{});
}

/// The smallest box around the corners of `box` at many moments.
Bounds3 sampled(const TransformList& list, const Bounds3& box, const Interval& when, int samples) {
  Bounds3 out;
  for (int i = 0; i <= samples; ++i) {
    const Affine map = list.at({when.lo + (when.hi - when.lo) * i / samples, 2});
    for (int corner = 0; corner < 8; ++corner) {
      out.add(map.point({corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                         corner & 4 ? box.hi.z : box.lo.z}));
    }
  }
  return out;
}

const Bounds3 kBox{{-1, -0.5, 2}, {1, 0.5, 3}};

TEST(MotionBoundsTest, EmptyUnboundedAndStillBoxes) {
  TransformList moving;
  moving.append(step(StepKind::kTranslate, {time(), 0, 0}));
  EXPECT_TRUE(moving.motion_bounds(Bounds3{}, {0, 1}, 0).empty());
  EXPECT_TRUE(moving.motion_bounds(Bounds3::everything(), {0, 1}, 0).unbounded());
  Bounds3 half = kBox;
  half.hi.x = Bounds3::kInf;
  EXPECT_TRUE(moving.motion_bounds(half, {0, 1}, 0).unbounded());
  TransformList still;
  still.append(translation({1, 2, 3}));
  expect_near(still.motion_bounds(kBox, {0, 1}, 0).lo, kBox.lo + Vec3{1, 2, 3});
  expect_near(TransformList{}.motion_bounds(kBox, {0, 1}, 0).hi, kBox.hi);
}

TEST(MotionBoundsTest, AMomentGivesTheBoxOfThatMoment) {
  TransformList list;
  list.append(step(StepKind::kRotate, {1, 1, 0, times(time(), 100)}));
  const Bounds3 bounds = list.motion_bounds(kBox, Interval::point(0.7), 2);
  const Bounds3 exact = sampled(list, kBox, Interval::point(0.7), 1);
  expect_near(bounds.lo, exact.lo);
  expect_near(bounds.hi, exact.hi);
}

TEST(MotionBoundsTest, CommonMotionsAreTight) {
  const auto expect_tight = [](const TransformList& list, double share) {
    const Interval when{0, 1};
    const Bounds3 bounds = list.motion_bounds(kBox, when, 2), exact = sampled(list, kBox, when, 4000);
    const Vec3 size = exact.extent(), grown_size = bounds.extent();
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(grown_size[axis], size[axis] * (1 + share) + 1e-9);
      EXPECT_GE(grown_size[axis], size[axis]);
    }
  };
  TransformList shift;
  shift.append(
      step(StepKind::kTranslate, {times(time(), 3), 0, Expression::apply(Operation::kNegate, {time()})}));
  expect_tight(shift, 1e-9);
  TransformList turn;
  turn.append(step(StepKind::kRotate, {0, 0, 1, times(time(), 360)}));
  expect_tight(turn, 0.05);
  TransformList slow;
  slow.append(step(StepKind::kRotate, {1, 2, 3, times(time(), 10)}));
  expect_tight(slow, 0.05);
  TransformList tumble;
  tumble.append(step(StepKind::kRotate, {0, 1, 0, times(time(), 200)}));
  tumble.append(translation({5, 0, 0}));
  tumble.append(step(StepKind::kRotate, {1, 0, 1, times(time(), 130)}));
  expect_tight(tumble, 0.08);
  TransformList swing;
  const Expression phase = times(time(), 40);
  swing.append(step(StepKind::kTranslate, {times(3, Expression::apply(Operation::kSin, {phase})), 0, 0}));
  expect_tight(swing, 0.05);
}

TEST(MotionBoundsTest, RandomMotionsStayInside) {
  const unsigned seed = 424242;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto uniform = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  const auto value = [&]() -> Expression {
    switch (random() % 6) {
      case 0:
        return uniform(-3, 3);
      case 1:
        return times(uniform(-3, 3), time());
      case 2:
        return Expression::apply(Operation::kSin, {times(uniform(-30, 30), time())});
      case 3:
        return Expression::apply(Operation::kLinear,
                                 {Expression(uniform(-1, 1)), Expression(uniform(-3, 3)),
                                  Expression(uniform(-1, 2)), Expression(uniform(-3, 3))});
      case 4:
        return Expression::apply(Operation::kAdd, {times(time(), time()), Expression(uniform(-1, 1))});
      default:
        return Expression::apply(Operation::kRemainder, {times(uniform(5, 50), time()), Expression(4)});
    }
  };
  int moments = 0;
  for (int i = 0; i < 300; ++i) {
    TransformList list;
    const int steps = 1 + static_cast<int>(random() % 4);
    for (int s = 0; s < steps; ++s) {
      switch (random() % 5) {
        case 0:
          list.append(step(StepKind::kScale, {value(), value(), value()}));
          break;
        case 1:
          list.append(step(StepKind::kTranslate, {value(), times(1e3, value()), value()}));
          break;
        case 2:
          list.append(step(StepKind::kRotate, {value(), value(), value(), times(90, value())}));
          break;
        case 3:
          list.append(step(StepKind::kMatrix, {value(), value(), value(), value(), value(), value(), value(),
                                               value(), value(), value(), value(), value()}));
          break;
        default:
          list.append(
              then(rotation_degrees({1, 2, uniform(-1, 1)}, 50), translation({uniform(-9, 9), 0, 1e4})));
      }
    }
    Bounds3 box;
    box.add(Vec3{uniform(-2, 2), uniform(-2, 2), uniform(-2, 2)});
    box.add(Vec3{uniform(-2, 2), uniform(-2, 2), uniform(-2, 2)});
    const Interval when{uniform(-1, 0), uniform(0, 2)};
    const Bounds3 bounds = list.motion_bounds(box, when, 1);
    for (int j = 0; j < 400; ++j) {
      const double t = j == 0 ? when.lo : j == 1 ? when.hi : uniform(when.lo, when.hi);
      Affine map;
      try {
        map = list.at({t, 1});
      } catch (const MotionError&) {
        continue;  // a remainder reached scale 0
      }
      ++moments;
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p{corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                     corner & 4 ? box.hi.z : box.lo.z};
        ASSERT_TRUE(bounds.contains(map.point(p))) << "list " << i << " at " << t;
      }
    }
  }
  EXPECT_GT(moments, 50000);
}

TEST(MotionBoundsTest, FastOscillationIsNotMissed) {
  // 10,000 turns within the interval: sampling would clip, intervals cannot.
  TransformList list;
  const Expression phase = times(time(), 2 * fn::kPi * 10000);
  list.append(step(StepKind::kTranslate, {times(7, Expression::apply(Operation::kSin, {phase})), 0, 0}));
  const Bounds3 bounds = list.motion_bounds(kBox, {0, 1}, 0);
  EXPECT_NEAR(bounds.lo.x, -8, 1e-6);
  EXPECT_NEAR(bounds.hi.x, 8, 1e-6);
}

TEST(MotionBoundsTest, PolesAreUnbounded) {
  TransformList list;
  list.append(
      step(StepKind::kTranslate, {Expression::apply(Operation::kDivide, {Expression(1), time()}), 0, 0}));
  EXPECT_TRUE(list.motion_bounds(kBox, {-1, 1}, 0).unbounded());
  EXPECT_FALSE(list.motion_bounds(kBox, {0.5, 1}, 0).unbounded());
}

}  // namespace
}  // namespace rayshade
