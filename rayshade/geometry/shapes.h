// SPDX-License-Identifier: MIT
// All compiled primitives. Every one is a small immutable struct with the same functions in the same order:
//
//   explicit X(const shape::X&)            from the scene's form; precomputes what a ray needs
//   bool intersect(ray, lo, hi, hit)       the nearest t beyond lo (open or closed as objects.md 2 says) with
//   t <= hi SurfacePoint surface_point(ray, hit)   point, normals, error bound bool entering(ray, lo, hit)
//   the enter test of CSG (objects.md 3) TextureCoordinates texture_coordinates(x, facing_normal, hit)   for
//   any x, also off the surface Bounds3 bounds()                       conservative; unbounded for planes
//
// `ray` is in primitive space, with a direction of any length; `facing_normal` is the geometric normal
// flipped toward the ray. The nearest hit is a function of (ray, lo) alone; `hi` only says from where on
// nobody is interested. No absolute tolerance lives in a shape: accuracy is relative to the numbers at hand,
// and reported as an error bound.
#pragma once

#include "rayshade/geometry/shapes/blob.h"
#include "rayshade/geometry/shapes/box.h"
#include "rayshade/geometry/shapes/cone.h"
#include "rayshade/geometry/shapes/cylinder.h"
#include "rayshade/geometry/shapes/disc.h"
#include "rayshade/geometry/shapes/height_field.h"
#include "rayshade/geometry/shapes/plane.h"
#include "rayshade/geometry/shapes/polygon.h"
#include "rayshade/geometry/shapes/sphere.h"
#include "rayshade/geometry/shapes/torus.h"
#include "rayshade/geometry/shapes/triangle.h"
