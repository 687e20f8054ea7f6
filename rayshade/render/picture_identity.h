// SPDX-License-Identifier: MIT
// What determines the pixels of a rendering, as names and values that can be compared and told to people.
#pragma once

#include <map>
#include <string>

#include "rayshade/render/frame_crew.h"
#include "rayshade/render/journal.h"
#include "rayshade/scene/scene.h"

namespace rayshade {

/// `scene` outlives the identity. `files`: names and hashes of the files that the scene names. `sample_map`:
/// alpha tells which pixels are fully sampled.
JournalIdentity picture_identity(const Scene& scene, const std::string& scene_hash,
                                 const RenderSettings& settings, const PictureFormat& format, bool sample_map,
                                 const std::map<std::string, std::string>& files, const std::string& version);

}  // namespace rayshade
