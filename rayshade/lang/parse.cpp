// SPDX-License-Identifier: MIT
// See parse.h.
#include "rayshade/lang/parse.h"

#include <fmt/format.h>

#include <utility>

#include "rayshade/lang/builder.h"
#include "rayshade/lang/context.h"
#include "rayshade/lang/messages.h"
#include "rayshade/lang/scanner_state.h"
#include "rayshade/lang/source_map.h"

namespace rayshade {
namespace lang {
namespace {

/// Reads the scene into `text`. False, with a message, where it cannot be read.
bool load(Provider& provider, const std::string& name, std::string* text, SourceMap& sources,
          Messages& messages) {
  const std::string shown = name == "-" ? "stdin" : name;
  sources.add_source(shown);
  try {
    *text = *provider.read(name);
  } catch (const ProviderError& error) {
    messages.error_in_file(shown, fmt::format("cannot read the scene: {}", error.what()));
    return false;
  }
  return true;
}

void parse_text(std::string& text, SourceMap& sources, Context& context) {
  if (text.size() > kMostScannedBytes) {
    context.messages.error_in_file(context.scene.file_names.front(), "the scene is longer than 2 GiB");
    return;
  }
  text.append(2, '\0');
  Scanner scanner(text, sources, context.messages);
  SceneBuilder builder(context);
  run_parser(scanner, builder);
}

}  // namespace
}  // namespace lang

ParseResult parse_scene(Provider& provider, const std::string& name, const ParseOptions& options) {
  ParseResult result;
  lang::SourceMap sources(result.scene.file_names);
  lang::Messages messages(sources, options.max_errors);
  lang::Context context{result.scene, sources, messages, options, result.prints};
  std::string text;
  if (lang::load(provider, name, &text, sources, messages)) {
    sources.set_text(0, text);
    lang::parse_text(text, sources, context);
  }
  result.diagnostics = messages.take();
  result.ok = messages.errors() == 0;
  return result;
}

}  // namespace rayshade
