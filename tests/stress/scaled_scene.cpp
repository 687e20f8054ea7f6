// SPDX-License-Identifier: MIT
#include "tests/stress/scaled_scene.h"

#include <cmath>
#include <cstring>

#include "rayshade/math/vec.h"
#include "tests/stress/markdown.h"

namespace rayshade::stress {
namespace {

/// Writes lengths and points of the scene as the world has them.
class Writer {
 public:
  Writer(double scale, const Vec3& offset) : scale_(scale), offset_(scale * offset) {}

  std::string length(double x) const { return format(" %.17g", scale_ * x); }
  std::string at(const Vec3& p) const {
    const Vec3 q = scale_ * p + offset_;
    return format(" %.17g %.17g %.17g", q.x, q.y, q.z);
  }
  std::string points(std::initializer_list<Vec3> all) const {
    std::string out;
    for (const Vec3& p : all) out += at(p);
    return out;
  }
  std::string sphere(double r, const Vec3& c) const { return length(r) + at(c); }
  std::string rod(double r, const Vec3& a, const Vec3& b) const { return length(r) + at(a) + at(b); }
  std::string cone(double r, const Vec3& a, double s, const Vec3& b) const {
    return length(r) + at(a) + length(s) + at(b);
  }
  std::string disc(double r, const Vec3& c, const char* normal) const { return length(r) + at(c) + normal; }
  std::string torus(double r, double s, const Vec3& c, const char* axis) const {
    return length(r) + length(s) + at(c) + axis;
  }
  std::string ball(double strength, double r, const Vec3& c) const {
    return format(" %g", strength) + length(r) + at(c);
  }
  /// What takes an object written in units to its place in the world; `scale` alone refuses small numbers.
  std::string placed() const {
    return format(" transform %.17g 0 0 0 %.17g 0 0 0 %.17g %.17g %.17g %.17g", scale_, scale_, scale_,
                  offset_.x, offset_.y, offset_.z);
  }

 private:
  double scale_;
  Vec3 offset_;
};

std::string objects(const Writer& w) {
  std::string t;
  const auto line = [&](const std::string& text) { t += text + "\n"; };
  line("difference");  // a floor with holes
  line("  plane floor" + w.at({0, 0, 0}) + " 0 0 1");
  line("  list");
  line("    sphere blue" + w.sphere(.5, {-.7, -2.7, .1}));
  line("    sphere white" + w.sphere(.3, {1.2, -2.2, .05}));
  line("  end");
  line("end");
  line("plane white" + w.at({0, 14, 0}) + " 0 -1 0");
  line("sphere red" + w.sphere(.8, {-3, -1, .8}) + " texture stripe white .3 0 map uv scale .25 .25 1");
  line("sphere mirror" + w.sphere(.6, {-1.4, -2.2, .6}));
  line("sphere glass" + w.sphere(.5, {.2, -3, .5}));
  line("box green" + w.at({-4.2, .8, 0}) + w.at({-3.2, 1.8, 1.4}));
  line("box glass" + w.at({1.6, -3.4, 0}) + w.at({2.2, -2.8, .7}));
  line("cylinder blue" + w.rod(.4, {-2, 1.2, 0}, {-2, 1.2, 1.6}) +
       " texture stripe white .3 0 map uv scale .25 .25 1");
  line("disc white" + w.disc(.4, {-2, 1.2, 1.6}, " 0 0 1"));
  line("cylinder red" + w.rod(.02, {-3, -2.5, .1}, {-1.5, -3.2, .3}));  // thin
  line("cone green" + w.cone(.5, {-.6, 1.4, 0}, 0, {-.6, 1.4, 1.7}) +
       " texture stripe white .3 0 map uv scale .25 .25 1");
  line("cone blue" + w.cone(.5, {.7, 2, .1}, .2, {.7, 1.6, 1.2}));
  line("torus red" + w.torus(.6, .2, {2, .6, .3}, " 0 .2 1") +
       " texture stripe white .3 0 map uv scale .25 .25 1");
  line("torus mirror" + w.torus(.5, .03, {2, .6, 1}, " .3 .2 1"));  // thin
  line("torus glass" + w.torus(.35, .14, {.4, -1.8, .5}, " .2 1 .1"));
  line("disc blue" + w.disc(.7, {3.6, 1.6, .9}, " -.5 -1 .3"));
  line("triangle green" + w.points({{2.6, -1.2, 0}, {3.8, -1, 0}, {3, -.6, 1.3}}) +
       " texture stripe white .3 0 map uv scale .25 .25 1");
  line("triangle white" + w.at({-4.6, -1, .2}) + " 1 0 .3" + w.at({-4.2, -2, .2}) + " 0 -1 .3" +
       w.at({-4.3, -1.4, 1.2}) + " 0 0 1");
  line("poly red" +
       w.points({{2.9, -2.4, .3}, {4.1, -2.4, .3}, {4.1, -1.6, .5}, {3.4, -1.9, .425}, {2.9, -1.6, .5}}));
  line("blob green" + format(" %g", .5) + w.ball(1, .6, {-.6, -.4, .5}) + w.ball(1, .6, {-.1, -.2, .5}) +
       w.ball(.8, .5, {-.4, -.4, 1}));
  line("difference");
  line("  box red" + w.at({1, -1.2, 0}) + w.at({1.8, -.4, .9}));
  line("  sphere white" + w.sphere(.45, {1.2, -1.1, .8}));
  line("end");
  line("intersect");
  line("  sphere blue" + w.sphere(.6, {3.2, .2, .4}));
  line("  plane white" + w.at({3.2, .2, .6}) + " .3 -.3 1");
  line("end");
  line("union");
  line("  sphere glass" + w.sphere(.3, {-2.4, -3.4, .3}));
  line("  sphere glass" + w.sphere(.3, {-2.1, -3.4, .3}));
  line("end");
  for (int i = 0; i < 40; ++i) {  // small things, for a hierarchy and for contact shadows
    const double angle = 2.39996 * i, radius = .07 * i;
    line("sphere mirror" + w.sphere(.05, {radius * std::cos(angle), -1 + radius * std::sin(angle), .05}));
  }
  return t;
}

}  // namespace

std::string scaled_scene(double scale, double offset, Placing placing, View view) {
  const Vec3 far{offset, -0.7 * offset, 0.4 * offset};
  const Writer world(scale, far), units(1, {});
  std::string t =
      "screen 200 150\nsample 1 nojitter\nmaxdepth 6\nbackground .5 .6 .8\n"
      "light .3 ambient\nlight .3 .3 .35 directional 1 .4 .8\n"
      "surface floor diffuse .6 .55 .5 specular .1 .1 .1 reflect .1\n"
      "surface red diffuse .8 .2 .15 specular .4 .4 .4 specpow 30\n"
      "surface green diffuse .2 .7 .25\n"
      "surface blue diffuse .2 .3 .8 specular .6 .6 .6 specpow 60 reflect .2\n"
      "surface white diffuse .8 .8 .8\n"
      "surface mirror diffuse .1 .1 .1 specular .8 .8 .8 specpow 80 reflect .75\n"
      "surface glass diffuse .05 .05 .05 specular .8 .8 .8 specpow 80 reflect .1 transp .8 index 1.3\n";
  // The telescope sees the same rectangle around the point looked at.
  const Vec3 target{-.1, -.5, .5}, eye = view == View::kNear ? Vec3{.4, -9, 4.5} : Vec3{10, -180, 85};
  t += "eyep" + world.at(eye) + "\nlookp" + world.at(target) +
       (view == View::kNear ? "\nfov 42\n" : "\nfov 2.1\n");
  t += "light .7 point" + world.at({-5, -6, 8}) + "\n";
  t += "light .3 extended" + world.length(.5) + world.at({6, -4, 7}) + "\n";
  t += "name chip list\n sphere red .1 0 0 .1\n disc white .15 0 0 .21 0 0 1 texture stripe red .3 0 map uv "
       "scale .25 .25 1\nend\n";
  const auto in_units = [&] {
    std::string inner = "heightfield green field.hf scale 2 2 1 translate -2.4 2.4 0\n";
    inner += "object chip translate .4 -.6 0\nobject chip scale 2 2 1 rotate 0 0 1 30 translate 1.2 2.6 0\n";
    inner += "sphere blue 1 0 0 0 scale .9 .01 .2 rotate 0 0 1 20 translate 3.6 2.8 .3\n";
    return inner;
  };
  if (placing == Placing::kWritten)
    return t + objects(world) + "list\n" + in_units() + "end" + world.placed() + "\n";
  return t + "list\n" + objects(units) + in_units() + "end" + world.placed() + "\n";
}

std::string scaled_field() {
  constexpr int kSize = 33;
  std::string out(4 + kSize * kSize * 4, '\0');
  std::memcpy(out.data(), &kSize, 4);
  for (int j = 0; j < kSize; ++j) {
    for (int i = 0; i < kSize; ++i) {
      const float z =
          static_cast<float>(.5 + .3 * std::sin(.5 * i) * std::cos(.37 * j) + .1 * std::sin(2.1 * i + j));
      std::memcpy(out.data() + 4 + 4 * (j * kSize + i), &z, 4);
    }
  }
  return out;
}

}  // namespace rayshade::stress
