// SPDX-License-Identifier: MIT
// See keywords.h. Look-up is one hash and, for nearly every word, one comparison: an open table filled at
// compile time.
#include "rayshade/lang/keywords.h"

#include <array>
#include <cstdint>

#include "parser.h"

namespace rayshade::lang {
namespace {

constexpr Keyword kKeywords[] = {
    // clang-format off
    {"ambient", TOKEN_AMBIENT}, {"aperture", TOKEN_APERTURE}, {"applysurf", TOKEN_APPLYSURF}, {"area",
    TOKEN_AREA}, {"atmosphere", TOKEN_ATMOSPHERE}, {"background", TOKEN_BACKGROUND}, {"blob", TOKEN_BLOB},
    {"blotch", TOKEN_BLOTCH}, {"body", TOKEN_BODY}, {"box", TOKEN_BOX}, {"bump", TOKEN_BUMP}, {"checker",
    TOKEN_CHECKER}, {"cloud", TOKEN_CLOUD}, {"component", TOKEN_COMPONENT}, {"cone", TOKEN_CONE}, {"contrast",
    TOKEN_CONTRAST}, {"crop", TOKEN_CROP}, {"cursurf", TOKEN_CURSURF}, {"cutoff", TOKEN_CUTOFF}, {"cylinder",
    TOKEN_CYLINDER}, {"cylindrical", TOKEN_CYLINDRICAL}, {"define", TOKEN_DEFINE}, {"difference",
    TOKEN_DIFFERENCE}, {"diffuse", TOKEN_DIFFUSE}, {"directional", TOKEN_DIRECTIONAL}, {"disc", TOKEN_DISC},
    {"end", TOKEN_END}, {"extended", TOKEN_EXTENDED}, {"extinct", TOKEN_EXTINCT}, {"eyep", TOKEN_EYEP},
    {"eyesep", TOKEN_EYESEP}, {"fbm", TOKEN_FBM}, {"fbmbump", TOKEN_FBMBUMP}, {"filter", TOKEN_FILTER},
    {"focaldist", TOKEN_FOCALDIST}, {"fog", TOKEN_FOG}, {"fogdeck", TOKEN_FOGDECK}, {"fov", TOKEN_FOV},
    {"framelength", TOKEN_FRAMELENGTH}, {"frames", TOKEN_FRAMES}, {"gauss", TOKEN_GAUSS}, {"gloss",
    TOKEN_GLOSS}, {"grid", TOKEN_GRID}, {"heightfield", TOKEN_HEIGHTFIELD}, {"image", TOKEN_IMAGE}, {"index",
    TOKEN_INDEX}, {"intersect", TOKEN_INTERSECT}, {"jitter", TOKEN_JITTER}, {"light", TOKEN_LIGHT}, {"list",
    TOKEN_LIST}, {"lookp", TOKEN_LOOKP}, {"map", TOKEN_MAP}, {"marble", TOKEN_MARBLE}, {"maxdepth",
    TOKEN_MAXDEPTH}, {"mist", TOKEN_MIST}, {"mount", TOKEN_MOUNT}, {"name", TOKEN_NAME}, {"nojitter",
    TOKEN_NOJITTER}, {"noshadow", TOKEN_NOSHADOW}, {"object", TOKEN_OBJECT}, {"outfile", TOKEN_OUTFILE},
    {"planar", TOKEN_PLANAR}, {"plane", TOKEN_PLANE}, {"point", TOKEN_POINT}, {"poly", TOKEN_POLY},
    {"polygon", TOKEN_POLY}, {"print", TOKEN_PRINT}, {"quiet", TOKEN_QUIET}, {"range", TOKEN_RANGE},
    {"reflect", TOKEN_REFLECT}, {"reflective", TOKEN_REFLECT}, {"report", TOKEN_REPORT}, {"resolution",
    TOKEN_SCREEN}, {"rotate", TOKEN_ROTATE}, {"sample", TOKEN_SAMPLE}, {"scale", TOKEN_SCALE}, {"screen",
    TOKEN_SCREEN}, {"shadowtransp", TOKEN_SHADOWTRANSP}, {"shutter", TOKEN_SHUTTER}, {"sky", TOKEN_SKY},
    {"smooth", TOKEN_SMOOTH}, {"specpow", TOKEN_SPECPOW}, {"specular", TOKEN_SPECULAR}, {"sphere",
    TOKEN_SPHERE}, {"spherical", TOKEN_SPHERICAL}, {"spot", TOKEN_SPOT}, {"starttime", TOKEN_STARTTIME},
    {"stripe", TOKEN_STRIPE}, {"surface", TOKEN_SURFACE}, {"textsurf", TOKEN_TEXTSURF}, {"texture",
    TOKEN_TEXTURE}, {"tile", TOKEN_TILE}, {"torus", TOKEN_TORUS}, {"transform", TOKEN_TRANSFORM},
    {"translate", TOKEN_TRANSLATE}, {"translu", TOKEN_TRANSLU}, {"translucency", TOKEN_TRANSLU}, {"transp",
    TOKEN_TRANSP}, {"transparent", TOKEN_TRANSP}, {"triangle", TOKEN_TRIANGLE}, {"triangleuv",
    TOKEN_TRIANGLEUV}, {"union", TOKEN_UNION}, {"up", TOKEN_UP}, {"uv", TOKEN_UV}, {"verbose", TOKEN_VERBOSE},
    {"window", TOKEN_WINDOW}, {"windy", TOKEN_WINDY}, {"wood", TOKEN_WOOD},
    // clang-format on
};
static_assert(std::size(kKeywords) == 108);

constexpr std::size_t kSlots = 1024;

constexpr std::size_t slot_of(std::string_view word) {
  std::uint32_t hash = static_cast<std::uint32_t>(word.size());
  for (const char c : word) hash = (hash ^ static_cast<unsigned char>(c)) * 0x01000193u;
  return (hash ^ (hash >> 15)) % kSlots;
}

/// Slot -> index into kKeywords plus one; 0 is free.
constexpr std::array<std::uint8_t, kSlots> fill() {
  std::array<std::uint8_t, kSlots> table{};
  for (std::size_t i = 0; i < std::size(kKeywords); ++i) {
    std::size_t slot = slot_of(kKeywords[i].name);
    while (table[slot] != 0) slot = (slot + 1) % kSlots;
    table[slot] = static_cast<std::uint8_t>(i + 1);
  }
  return table;
}

constexpr std::array<std::uint8_t, kSlots> kTable = fill();
constexpr std::size_t kLongest = 12;  // "shadowtransp", "translucency"

}  // namespace

std::span<const Keyword> keywords() { return kKeywords; }

int keyword_token(std::string_view word) {
  if (word.size() > kLongest) return 0;
  for (std::size_t slot = slot_of(word); kTable[slot] != 0; slot = (slot + 1) % kSlots) {
    const Keyword& keyword = kKeywords[kTable[slot] - 1];
    if (keyword.name == word) return keyword.token;
  }
  return 0;
}

}  // namespace rayshade::lang
