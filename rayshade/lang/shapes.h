// SPDX-License-Identifier: MIT
// Primitives (language.md 3.7, objects.md 4): checks what was written, drops what is degenerate with a
// message, and stores the rest. Each function gives the node, or kNone.
//
// Only what has no extent at all is degenerate, or what doubles cannot square: the absolute thresholds of the
// original would make small models fall apart (objects.md 12, G12, G13).
#pragma once

#include "rayshade/lang/objects.h"

namespace rayshade::lang {

class Shapes {
 public:
  Shapes(Context& context, Objects& objects) : context_(context), objects_(objects) {}

  NodeId plane(const Span& at, const Vec3& point, const Vec3& normal);
  NodeId sphere(const Span& at, double radius, const Vec3& center);
  NodeId box(const Span& at, const Vec3& a, const Vec3& b);
  NodeId disc(const Span& at, double radius, const Vec3& center, const Vec3& normal);
  NodeId cylinder(const Span& at, double radius, const Vec3& bottom, const Vec3& top);
  NodeId cone(const Span& at, double bottom_radius, const Vec3& bottom, double top_radius, const Vec3& top);
  NodeId torus(const Span& at, double swept, double tube, const Vec3& center, const Vec3& axis);
  NodeId triangle(const Span& at, const Vec3& p1, const Vec3& p2, const Vec3& p3);
  NodeId smooth_triangle(const Span& at, const Vec3& p1, const Vec3& n1, const Vec3& p2, const Vec3& n2,
                         const Vec3& p3, const Vec3& n3);
  /// The next corner of triangleuv.
  void corner(const Vec3& point, const Vec3& normal, double u, double v);
  NodeId uv_triangle(const Span& at);
  /// The next vertex of a polygon.
  void point(const Vec3& p) { points_.push_back(p); }
  NodeId polygon(const Span& at);
  /// The next metaball of a blob.
  void ball(double strength, double radius, const Vec3& center) {
    balls_.push_back({strength, radius, center});
  }
  NodeId blob(const Span& at, double threshold);
  NodeId height_field(const Span& at, Name file, const Span& file_span);

  /// Drops unfinished work, after a mistake.
  void recover();

 private:
  NodeId drop(const Span& at, const char* why);
  NodeId drop_quietly();
  bool check_smooth(const Span& at, const Vec3 (&p)[3], const Vec3 (&n)[3]);
  template <typename Shape>
  NodeId store(NodeKind kind, const Span& at, std::deque<Shape>& pool, Shape shape);

  Context& context_;
  Objects& objects_;
  shape::UvTriangle corners_;
  int corner_count_ = 0;
  std::vector<Vec3> points_;
  std::vector<shape::Metaball> balls_;
};

}  // namespace rayshade::lang
