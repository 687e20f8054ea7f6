// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shape_pools.h"

#include <fmt/format.h>

#include "rayshade/image/height_field_file.h"

namespace rayshade {
namespace {

template <class Pool, class... Arguments>
std::uint32_t append(Pool& pool, Arguments&&... arguments) {
  pool.emplace_back(std::forward<Arguments>(arguments)...);
  return static_cast<std::uint32_t>(pool.size() - 1);
}

}  // namespace

ShapePools::ShapePools(const Scene& scene, const SceneFacts& facts, Provider& provider, bool flip_normals,
                       CompiledScene& out)
    : scene_(scene), provider_(provider), flip_normals_(flip_normals), out_(out) {
  const std::array<std::size_t, kPrimitiveKinds> written{
      scene.planes.size(),           scene.spheres.size(),      scene.boxes.size(),    scene.discs.size(),
      scene.cylinders.size(),        scene.cones.size(),        scene.tori.size(),     scene.triangles.size(),
      scene.smooth_triangles.size(), scene.uv_triangles.size(), scene.polygons.size(), scene.blobs.size(),
      scene.height_fields.size()};
  for (std::size_t kind = 0; kind < written.size(); ++kind) built_[kind].assign(written[kind], kNone);
  // Exact reservations: growing a pool of a million triangles would hold it twice.
  out.planes.reserve(facts.reachable(NodeKind::kPlane));
  out.spheres.reserve(facts.reachable(NodeKind::kSphere));
  out.boxes.reserve(facts.reachable(NodeKind::kBox));
  out.discs.reserve(facts.reachable(NodeKind::kDisc));
  out.cylinders.reserve(facts.reachable(NodeKind::kCylinder));
  out.cones.reserve(facts.reachable(NodeKind::kCone));
  out.tori.reserve(facts.reachable(NodeKind::kTorus));
  out.triangles.reserve(facts.reachable(NodeKind::kTriangle));
  out.smooth_triangles.reserve(facts.reachable(NodeKind::kSmoothTriangle));
  out.uv_triangles.reserve(facts.reachable(NodeKind::kUvTriangle));
  out.polygons.reserve(facts.reachable(NodeKind::kPolygon));
  out.blobs.reserve(facts.reachable(NodeKind::kBlob));
  out.height_fields.reserve(facts.reachable(NodeKind::kHeightField));
}

std::uint32_t ShapePools::index_of(const Node& node) {
  std::uint32_t& index = built_[static_cast<std::size_t>(node.kind)][node.payload];
  if (index == kNone) index = build(node);
  return index;
}

std::uint32_t ShapePools::build(const Node& node) {
  const std::uint32_t i = node.payload;
  switch (node.kind) {
    case NodeKind::kPlane:
      return append(out_.planes, scene_.planes[i]);
    case NodeKind::kSphere:
      return append(out_.spheres, scene_.spheres[i]);
    case NodeKind::kBox:
      return append(out_.boxes, scene_.boxes[i]);
    case NodeKind::kDisc:
      return append(out_.discs, scene_.discs[i]);
    case NodeKind::kCylinder:
      return append(out_.cylinders, scene_.cylinders[i]);
    case NodeKind::kCone:
      return append(out_.cones, scene_.cones[i]);
    case NodeKind::kTorus:
      return append(out_.tori, scene_.tori[i]);
    case NodeKind::kTriangle:
      return append(out_.triangles, scene_.triangles[i], flip_normals_);
    case NodeKind::kSmoothTriangle:
      return append(out_.smooth_triangles, scene_.smooth_triangles[i], flip_normals_);
    case NodeKind::kUvTriangle:
      return append(out_.uv_triangles, scene_.uv_triangles[i], flip_normals_);
    case NodeKind::kPolygon:
      return append(out_.polygons, scene_.polygons[i], flip_normals_);
    case NodeKind::kBlob:
      return append(out_.blobs, scene_.blobs[i]);
    case NodeKind::kHeightField:
      return append(out_.height_fields, read_height_field(scene_.height_fields[i].file));
    default:
      throw CompileError("not a primitive", node.location);
  }
}

void ShapePools::check_files() {
  for (const shape::HeightField& field : scene_.height_fields) read_height_field(field.file);
}

std::shared_ptr<const HeightFieldData> ShapePools::read_height_field(const FileReference& file) {
  std::shared_ptr<const HeightFieldData>& data = files_[file.name];
  if (data) return data;
  const auto fail = [&](const char* why) {
    return CompileError(fmt::format("cannot read height field \"{}\": {}", file.name, why), file.location);
  };
  try {
    const Bytes bytes = provider_.read(file.name);
    data = std::make_shared<const HeightFieldData>(rayshade::read_height_field(*bytes));
    // Two triangles a cell are numbered with 32 bits.
    if (data->size > 46341) throw HeightFieldError("too many points");
  } catch (const ProviderError& error) {
    throw fail(error.what());
  } catch (const HeightFieldError& error) {
    throw fail(error.what());
  }
  return data;
}

}  // namespace rayshade
