// SPDX-License-Identifier: MIT
// The files that a scene needs, recorded while rank 0 reads them, and sent to slaves that have no disk in
// common with it.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "rayshade/scene/provider.h"

namespace pafas {

/// Reads files, and keeps what it read.
class RecordingProvider final : public rayshade::Provider {
 public:
  rayshade::Bytes read(const std::string& name) override;
  /// All files read so far as compressed bytes (zlib).
  std::string package() const;
  /// Lets go of them: they are as large as the scene.
  void forget();

 private:
  rayshade::FileProvider files_;
  mutable std::mutex mutex_;
  std::map<std::string, rayshade::Bytes> read_;
};

/// Adds the files of a package to a provider. Throws ArchiveError for bytes that are none.
void unpack_files(std::string_view package, rayshade::MemoryProvider& into);

}  // namespace pafas
