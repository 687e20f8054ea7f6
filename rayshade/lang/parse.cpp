// SPDX-License-Identifier: MIT
// See parse.h.
#include "rayshade/lang/parse.h"

#include <fmt/format.h>

#include <utility>

#include "rayshade/lang/builder.h"
#include "rayshade/lang/context.h"
#include "rayshade/lang/messages.h"
#include "rayshade/lang/preprocessor.h"
#include "rayshade/lang/scanner_state.h"
#include "rayshade/lang/source_map.h"

namespace rayshade {
namespace lang {
namespace {

/// NULs with which the scanner wants a text to end.
constexpr std::size_t kEndOfText = 2;

/// Reads and preprocesses the scene into `text`. False, with messages, where there is nothing to parse.
bool load(Provider& provider, const std::string& name, Context& context, std::string* text) {
  const std::string shown = name == "-" ? "stdin" : name;
  const ParseOptions& options = context.options;
  context.sources.add_source(shown);
  Bytes bytes;
  try {
    bytes = provider.read(name);
  } catch (const ProviderError& error) {
    context.messages.error_in_file(shown, fmt::format("cannot read the scene: {}", error.what()));
    return false;
  }
  const bool wanted = options.preprocessing == Preprocessing::kAlways ||
                      (options.preprocessing == Preprocessing::kAuto && has_directive(*bytes));
  if (!wanted) {
    text->reserve(bytes->size() + kEndOfText);  // see parse_text(): it is as long as the scene
    *text = *bytes;
    return true;
  }
  context.sources.keep(0, std::move(bytes));
  Preprocessor preprocessor(provider, context.sources, context.messages);
  preprocessor.set_arguments(options.preprocessor_arguments);
  *text = preprocessor.run(name);
  return !context.messages.stopped();
}

void parse_text(std::string& text, Context& context) {
  if (text.size() > kMostScannedBytes) {
    context.messages.error_in_file(context.scene.file_names.front(), "the scene is longer than 2 GiB");
    return;
  }
  text.append(kEndOfText, '\0');
  // Without preprocessing the text is the source itself.
  if (context.sources.text(0).empty())
    context.sources.set_text(0, std::string_view(text).substr(0, text.size() - kEndOfText));
  Scanner scanner(text, context.sources, context.messages);
  SceneBuilder builder(context);
  run_parser(scanner, builder);
}

}  // namespace
}  // namespace lang

ParseResult parse_scene(Provider& provider, const std::string& name, const ParseOptions& options) {
  ParseResult result;
  lang::SourceMap sources(result.scene.file_names);
  lang::Messages messages(sources, options.max_errors);
  lang::Context context{result.scene, sources, messages, options, result.prints, result.notes};
  std::string text;
  if (lang::load(provider, name, context, &text)) lang::parse_text(text, context);
  result.diagnostics = messages.take();
  result.ok = messages.errors() == 0;
  return result;
}

}  // namespace rayshade
