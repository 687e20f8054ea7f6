// SPDX-License-Identifier: MIT
// Primitives and textures as canonical text.
#include "rayshade/scene/scene_text.h"

namespace rayshade {
namespace {

void write_mapping(TextWriter& out, const Mapping& mapping) {
  out.word("map");
  switch (mapping.kind) {
    case MappingKind::kUv:
      out.word("uv");
      return;
    case MappingKind::kSpherical:
      out.word("spherical");
      break;
    case MappingKind::kCylindrical:
      out.word("cylindrical");
      break;
    case MappingKind::kPlanar:
      out.word("planar");
      break;
  }
  if (!mapping.explicit_axes) return;
  out.vec(mapping.origin);
  out.vec(mapping.up);
  out.vec(mapping.u_axis);
}

const char* component_word(ImageComponent component) {
  switch (component) {
    case ImageComponent::kColor:
      return nullptr;
    case ImageComponent::kAmbient:
      return "ambient";
    case ImageComponent::kDiffuse:
      return "diffuse";
    case ImageComponent::kSpecular:
      return "specular";
    case ImageComponent::kBody:
      return "body";
    case ImageComponent::kReflect:
      return "reflect";
    case ImageComponent::kTransp:
      return "transp";
    case ImageComponent::kSpecpow:
      return "specpow";
    case ImageComponent::kBump:
      return "bump";
    case ImageComponent::kIndex:
      return "index";
  }
  return nullptr;
}

void write_image(TextWriter& out, const Texture& texture, SurfaceNames& surfaces) {
  const ImageOptions& image = texture.image;
  out.word("image");
  out.file(texture.file.name);
  if (const char* component = component_word(image.component)) {
    out.word("component");
    out.word(component);
  }
  out.word("tile");
  out.number(image.tile_u);
  out.number(image.tile_v);
  out.word("range");
  out.number(image.range_high);
  out.number(image.range_low);
  if (image.smooth) out.word("smooth");
  if (image.has_surface) {
    out.word("textsurf");
    out.word(surfaces.name(texture.surface));
  }
  write_mapping(out, texture.mapping);
}

/// Keyword, surface and then `arguments`.
template <class Arguments>
void write_shape(TextWriter& out, const char* keyword, const std::string* surface, Arguments&& arguments) {
  out.word(keyword);
  if (surface) out.word(*surface);
  arguments();
}

}  // namespace

void write_texture(TextWriter& out, const Texture& texture, SurfaceNames& surfaces) {
  const double* a = texture.arguments;
  const auto numbers = [&](int first, int last) {
    for (int i = first; i < last; ++i) out.number(a[i]);
  };
  const auto optional_file = [&] {
    if (texture.file.given()) out.file(texture.file.name);
  };
  out.word("texture");
  switch (texture.kind) {
    case TextureKind::kChecker:
      out.word("checker");
      out.word(surfaces.name(texture.surface));
      break;
    case TextureKind::kBlotch:
      out.word("blotch");
      numbers(0, 1);
      out.word(surfaces.name(texture.surface));
      break;
    case TextureKind::kBump:
      out.word("bump");
      numbers(0, 1);
      break;
    case TextureKind::kMarble:
      out.word("marble");
      optional_file();
      break;
    case TextureKind::kFbm:
      out.word("fbm");
      numbers(0, 4);
      out.integer(texture.octaves);
      numbers(4, 5);
      optional_file();
      break;
    case TextureKind::kFbmBump:
      out.word("fbmbump");
      numbers(0, 4);
      out.integer(texture.octaves);
      break;
    case TextureKind::kWood:
      out.word("wood");
      break;
    case TextureKind::kGloss:
      out.word("gloss");
      numbers(0, 1);
      break;
    case TextureKind::kCloud:
      out.word("cloud");
      numbers(0, 3);
      out.integer(texture.octaves);
      numbers(3, 6);
      break;
    case TextureKind::kSky:
      out.word("sky");
      numbers(0, 3);
      out.integer(texture.octaves);
      numbers(3, 5);
      break;
    case TextureKind::kStripe:
      out.word("stripe");
      out.word(surfaces.name(texture.surface));
      numbers(0, 2);
      write_mapping(out, texture.mapping);
      break;
    case TextureKind::kWindy:
      out.word("windy");
      numbers(0, 4);
      out.integer(texture.octaves);
      numbers(4, 7);
      break;
    case TextureKind::kMount:
      out.word("mount");
      out.file(texture.file.name);
      numbers(0, 2);
      break;
    case TextureKind::kImage:
      write_image(out, texture, surfaces);
      break;
  }
  write_transforms(out, texture.transform);
}

void write_primitive(TextWriter& out, const Scene& scene, const Node& node, SurfaceNames& surfaces) {
  const std::string* surface = node.surface == kNone ? nullptr : &surfaces.name(scene.surfaces[node.surface]);
  const auto write = [&](const char* keyword, auto&& arguments) {
    write_shape(out, keyword, surface, arguments);
  };
  switch (node.kind) {
    case NodeKind::kPlane:
      return write("plane", [&, &s = scene.planes[node.payload]] {
        out.vec(s.point);
        out.vec(s.normal);
      });
    case NodeKind::kSphere:
      return write("sphere", [&, &s = scene.spheres[node.payload]] {
        out.number(s.radius);
        out.vec(s.center);
      });
    case NodeKind::kBox:
      return write("box", [&, &s = scene.boxes[node.payload]] {
        out.vec(s.lo);
        out.vec(s.hi);
      });
    case NodeKind::kDisc:
      return write("disc", [&, &s = scene.discs[node.payload]] {
        out.number(s.radius);
        out.vec(s.center);
        out.vec(s.normal);
      });
    case NodeKind::kCylinder:
      return write("cylinder", [&, &s = scene.cylinders[node.payload]] {
        out.number(s.radius);
        out.vec(s.bottom);
        out.vec(s.top);
      });
    case NodeKind::kCone:
      return write("cone", [&, &s = scene.cones[node.payload]] {
        out.number(s.bottom_radius);
        out.vec(s.bottom);
        out.number(s.top_radius);
        out.vec(s.top);
      });
    case NodeKind::kTorus:
      return write("torus", [&, &s = scene.tori[node.payload]] {
        out.number(s.swept);
        out.number(s.tube);
        out.vec(s.center);
        out.vec(s.axis);
      });
    case NodeKind::kTriangle:
      return write("triangle", [&, &s = scene.triangles[node.payload]] {
        for (const Vec3& p : s.p) out.vec(p);
      });
    case NodeKind::kSmoothTriangle:
      return write("triangle", [&, &s = scene.smooth_triangles[node.payload]] {
        for (int i = 0; i < 3; ++i) {
          out.vec(s.p[i]);
          out.vec(s.n[i]);
        }
      });
    case NodeKind::kUvTriangle:
      return write("triangleuv", [&, &s = scene.uv_triangles[node.payload]] {
        for (int i = 0; i < 3; ++i) {
          out.vec(s.p[i]);
          out.vec(s.n[i]);
          out.number(s.u[i]);
          out.number(s.v[i]);
        }
      });
    case NodeKind::kPolygon:
      return write("polygon", [&, &s = scene.polygons[node.payload]] {
        for (const Vec3& p : s.points) out.vec(p);
      });
    case NodeKind::kBlob:
      return write("blob", [&, &s = scene.blobs[node.payload]] {
        out.number(s.threshold);
        for (const shape::Metaball& ball : s.balls) {
          out.number(ball.strength);
          out.number(ball.radius);
          out.vec(ball.center);
        }
      });
    case NodeKind::kHeightField:
      return write("heightfield", [&, &s = scene.height_fields[node.payload]] { out.file(s.file.name); });
    default:
      break;  // aggregates and instances are no primitives
  }
}

}  // namespace rayshade
