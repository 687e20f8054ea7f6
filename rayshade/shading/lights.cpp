// SPDX-License-Identifier: MIT
#include "rayshade/shading/lights.h"

#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

constexpr double kDegree = fn::kPi / 180;

ShadingLight prepare(const Light& light) {
  ShadingLight out;
  out.kind = light.kind;
  out.no_shadow = light.no_shadow;
  out.intensity = light.intensity;
  out.position = light.position;
  if (light.kind == LightKind::kDirectional) out.position = normalize(light.position);
  if (light.kind == LightKind::kSpot) {
    out.axis = normalize(light.target - light.position);
    out.exponent = light.exponent;
    out.cos_inner = fn::cos(light.inner * kDegree);
    out.cos_outer = fn::cos(light.outer * kDegree);
    out.cone = light.inner < 90 && out.cos_inner > 0;
  }
  out.radius = light.radius;
  out.black = light.intensity == Color{};
  return out;
}

}  // namespace

std::vector<ShadingLight> prepare_lights(const Scene& scene, const RenderSettings& settings) {
  std::vector<Light> written(scene.lights);
  if (written.empty()) written.push_back(default_light());
  std::vector<ShadingLight> lights;
  for (const Light& light : written) {
    ShadingLight base = prepare(light);
    if (light.kind != LightKind::kArea) {
      lights.push_back(base);
      continue;
    }
    // Cells with v outer and u inner, each of its share of the intensity (shading.md 4.3).
    const int nu = light.u_samples, nv = light.v_samples;
    if (settings.sobol()) {
      const int samples = settings.samples * settings.samples;
      base.turns = static_cast<std::uint32_t>((nu * nv + samples - 1) / samples);
      base.edge_u = light.u_end - light.position;
      base.edge_v = light.v_end - light.position;
      base.intensity = light.intensity * (1.0 / base.turns);
      for (; base.turn < base.turns; ++base.turn) lights.push_back(base);
      continue;
    }
    base.edge_u = (light.u_end - light.position) / nu;
    base.edge_v = (light.v_end - light.position) / nv;
    base.intensity = light.intensity * (1.0 / (static_cast<double>(nu) * nv));
    for (int j = 0; j < nv; ++j) {
      for (int i = 0; i < nu; ++i) {
        ShadingLight cell = base;
        cell.position =
            light.position + static_cast<double>(i) * base.edge_u + static_cast<double>(j) * base.edge_v;
        lights.push_back(cell);
      }
    }
  }
  std::reverse(lights.begin(), lights.end());
  for (std::size_t l = 0; l < lights.size(); ++l) {
    const bool again = l > 0 && lights[l].turn + 1 < lights[l].turns;
    lights[l].sequence = again ? lights[l - 1].sequence : static_cast<std::uint32_t>(l);
  }
  return lights;
}

std::string light_name(const std::vector<ShadingLight>& lights, std::size_t light) {
  return "light " + std::to_string(lights.size() - light) + " (" + name_of(lights[light].kind) + ")";
}

RayClass shadow_class(const ShadingLight& light) {
  switch (light.kind) {
    case LightKind::kPoint:
    case LightKind::kSpot:
      return {RayClass::Kind::kPoint, light.position, {}};
    case LightKind::kDirectional:
      return {RayClass::Kind::kParallel, light.position, {}};
    case LightKind::kArea: {
      RayClass out;
      for (const Vec3& corner : {Vec3{}, light.edge_u, light.edge_v, light.edge_u + light.edge_v})
        out.bounds.add(light.position + corner);
      return out;
    }
    case LightKind::kExtended: {
      // Targets lie in a square of that half side, turned toward the point (extended_target).
      const double r = std::sqrt(2) * light.radius;
      RayClass out;
      out.bounds = {light.position - Vec3{r, r, r}, light.position + Vec3{r, r, r}};
      return out;
    }
    default:
      return {};
  }
}

double spot_factor(const ShadingLight& light, double x) {
  if (!(x > 0)) return 0;
  double ramp = 1;
  if (light.cone) {
    const double inner = light.cos_inner, outer = light.cos_outer;
    if (x < outer || (x == outer && inner == outer)) return 0;
    if (x <= inner) {
      const double w = (x - outer) / (inner - outer);
      ramp = w * w * (3 - 2 * w);
    }
  }
  if (light.exponent == 0) return ramp;
  return fn::pow_by_log(x, light.exponent) * ramp;
}

Vec3 extended_target(const ShadingLight& light, const Vec3& point, int sample_number, int side, double xi,
                     double zeta) {
  const Vec3 center = light.position - point;
  Vec3 e1, e2;
  coordinate_system(center, e1, e2);
  const double step = 2 * light.radius / side;
  const int column = sample_number % side, row = sample_number / side;
  const double v = -light.radius + (column + xi) * step;
  const double w = -light.radius + (row + zeta) * step;
  return center + w * e1 + v * e2;
}

}  // namespace rayshade
