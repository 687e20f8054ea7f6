// SPDX-License-Identifier: MIT
// What the grammar calls: one builder per part of the language, and the two things that concern them all,
// recovery from a mistake and the wording of syntax errors.
#pragma once

#include <string_view>
#include <vector>

#include "rayshade/lang/expressions.h"
#include "rayshade/lang/lights.h"
#include "rayshade/lang/objects.h"
#include "rayshade/lang/settings_builder.h"
#include "rayshade/lang/shapes.h"
#include "rayshade/lang/surfaces.h"
#include "rayshade/lang/textures.h"
#include "rayshade/lang/transforms.h"

namespace rayshade::lang {

class Scanner;

class SceneBuilder {
 public:
  explicit SceneBuilder(Context& context)
      : settings(context),
        expressions(context),
        lights(context),
        surfaces(context),
        transforms(context, expressions),
        textures(context),
        objects(context, surfaces),
        shapes(context, objects),
        context_(context) {}

  Settings settings;
  Expressions expressions;
  Lights lights;
  Surfaces surfaces;
  Transforms transforms;
  Textures textures;
  Objects objects;
  Shapes shapes;

  /// Drops the unfinished work of the item that was wrong.
  void recover();
  /// Something stands where the grammar does not allow it. `token` and `expected` are names of the grammar.
  void syntax_error(const Span& span, std::string_view token, const std::vector<std::string_view>& expected,
                    Scanner& scanner);
  /// The parser's stack has reached its limit.
  void exhausted(const Span& span);

 private:
  std::string syntax_suggestion(std::string_view token, std::string_view word,
                                const std::vector<std::string_view>& expected, const Scanner& scanner) const;

  Context& context_;
};

/// Parses the text of the scanner. Errors are in the messages.
void run_parser(Scanner& scanner, SceneBuilder& builder);

}  // namespace rayshade::lang
