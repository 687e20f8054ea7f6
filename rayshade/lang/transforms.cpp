// SPDX-License-Identifier: MIT
// See transforms.h.
#include "rayshade/lang/transforms.h"

#include <fmt/format.h>

#include <utility>

namespace rayshade::lang {

void Transforms::append(const Affine& map, const Span& span) {
  last_ = span;
  list_.append(map);
}

void Transforms::step(StepKind kind, std::array<Expression, 12> arguments, const Span& span) {
  list_.append(AnimatedStep{kind, std::move(arguments), context_.sources.locate(span)});
}

void Transforms::scale(Value x, Value y, Value z, const Span& span) {
  const bool varies = x.varying || y.varying || z.varying;
  std::array<Expression, 12> a{expressions_.take(x, span), expressions_.take(y, span),
                               expressions_.take(z, span)};
  for (int i = 0; i < 3; ++i) {
    if (!a[i].constant()) continue;
    const double factor = a[i].evaluate(Moment{});
    if (is_scale_factor(factor)) continue;
    context_.messages.error(span, fmt::format("degenerate scale: factor {} is {}", "xyz"[i], factor));
    return;
  }
  if (varies) return step(StepKind::kScale, std::move(a), span);
  append(scaling({a[0].evaluate({}), a[1].evaluate({}), a[2].evaluate({})}), span);
}

void Transforms::translate(Value x, Value y, Value z, const Span& span) {
  const bool varies = x.varying || y.varying || z.varying;
  std::array<Expression, 12> a{expressions_.take(x, span), expressions_.take(y, span),
                               expressions_.take(z, span)};
  if (varies) return step(StepKind::kTranslate, std::move(a), span);
  append(translation({a[0].evaluate({}), a[1].evaluate({}), a[2].evaluate({})}), span);
}

void Transforms::rotate(Value x, Value y, Value z, Value degrees, const Span& span) {
  const bool axis_varies = x.varying || y.varying || z.varying;
  const bool varies = axis_varies || degrees.varying;
  std::array<Expression, 12> a{expressions_.take(x, span), expressions_.take(y, span),
                               expressions_.take(z, span), expressions_.take(degrees, span)};
  if (!axis_varies) {
    const Vec3 axis{a[0].evaluate({}), a[1].evaluate({}), a[2].evaluate({})};
    if (max_abs(axis) == 0) {
      context_.messages.warning(span, "degenerate rotation axis: the rotation is left out");
      return;
    }
    if (!varies) return append(rotation_degrees(axis, a[3].evaluate({})), span);
  }
  step(StepKind::kRotate, std::move(a), span);
}

void Transforms::row(Value x, Value y, Value z) { rows_.insert(rows_.end(), {x, y, z}); }

void Transforms::matrix(const Span& span) {
  bool varies = false;
  std::array<Expression, 12> a;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    varies = varies || rows_[i].varying;
    a[i] = expressions_.take(std::exchange(rows_[i], Value{0, nullptr}), span);
  }
  rows_.clear();
  if (varies) return step(StepKind::kMatrix, std::move(a), span);
  Affine map;
  for (int i = 0; i < 3; ++i) {
    map.rows[i] = {a[3 * i].evaluate({}), a[3 * i + 1].evaluate({}), a[3 * i + 2].evaluate({})};
  }
  map.translation = {a[9].evaluate({}), a[10].evaluate({}), a[11].evaluate({})};
  if (!inverse(map)) {
    context_.messages.error(span, "singular matrix: this transform flattens space");
    return;
  }
  append(map, span);
}

TransformList Transforms::take() {
  TransformList list = std::exchange(list_, TransformList());
  // Each transform can be undone, but many in a row may leave the range of doubles.
  for (const TransformList::Element& element : list.elements()) {
    if (element.animated || inverse(element.constant)) continue;
    context_.messages.error(last_, "singular matrix: these transforms together flatten space");
    return {};
  }
  return list;
}

void Transforms::recover() {
  for (Value& value : rows_) destroy(value);
  rows_.clear();
  list_ = TransformList();
}

}  // namespace rayshade::lang
