// SPDX-License-Identifier: MIT
// Any bytes as a scene: parsing must end, stay in bounds, and give either errors or a scene whose canonical
// text parses to itself. Built for libFuzzer, and with replay.cpp as an ordinary test over the kept corpus.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "rayshade/lang/parse.h"

namespace {

rayshade::ParseResult parse(const std::string& text, rayshade::Preprocessing preprocessing) {
  rayshade::MemoryProvider provider;
  provider.add("scene.ray", text);
  provider.add("inc.ray", "#define INCLUDED 1\nsurface included diffuse 1 0 0\n");
  rayshade::ParseOptions options;
  options.preprocessing = preprocessing;
  options.preprocessor_arguments = {"-DFLAG=1", "-Idir"};
  options.verbose = true;
  return rayshade::parse_scene(provider, "scene.ray", options);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const auto mode : {rayshade::Preprocessing::kAuto, rayshade::Preprocessing::kNever}) {
    const rayshade::ParseResult result = parse(text, mode);
    std::size_t shown = 0;
    for (const rayshade::Diagnostic& d : result.diagnostics)
      shown += rayshade::format_diagnostic(d, true).size();
    if (!result.ok && shown == 0) std::abort();  // a failure must say why
    if (!result.ok) continue;
    const std::string canonical = rayshade::canonical_text(result.scene);
    const rayshade::ParseResult again = parse(canonical, rayshade::Preprocessing::kNever);
    if (!again.ok || rayshade::canonical_text(again.scene) != canonical) std::abort();
  }
  return 0;
}
