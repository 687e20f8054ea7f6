// SPDX-License-Identifier: MIT
// Notes the hash of every file read through it: a scene is the same only where the files it names are.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "rayshade/scene/provider.h"

namespace rayshade {

class HashingProvider : public Provider {
 public:
  explicit HashingProvider(Provider& provider) : provider_(provider) {}
  Bytes read(const std::string& name) override;
  /// Names of files and hashes (hash128.h) of what was in them. Not while others read.
  const std::map<std::string, std::string>& hashes() const { return hashes_; }

 private:
  Provider& provider_;
  std::mutex mutex_;
  std::map<std::string, std::string> hashes_;  ///< guarded by mutex_
};

}  // namespace rayshade
