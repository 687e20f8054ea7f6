// SPDX-License-Identifier: MIT
// The cells of the eye tree tile the window, and are as many as the statistics say.
#include "rayshade/render/tree_cells.h"

#include <gtest/gtest.h>

#include "tests/unit/render/crowd.h"

namespace rayshade {
namespace {

using test::crowd;
using test::Rendered;

/// Whether a convex polygon, its border included, holds a point.
bool holds(const TreeCell& cell, double x, double y) {
  int left = 0, right = 0;
  for (std::size_t i = 0; i < cell.corners.size(); ++i) {
    const auto &a = cell.corners[i], &b = cell.corners[(i + 1) % cell.corners.size()];
    const double side = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
    left += side > 0;
    right += side < 0;
  }
  return left == 0 || right == 0;
}

struct Drawn {
  TreeCells cells;
  RenderSettings settings;
  std::uint64_t leaves_now = 0;

  double area() const {
    double sum = 0;
    for (const TreeCell& cell : cells.visible) sum += area_of(cell);
    return sum;
  }
  double window() const { return double(settings.window_width()) * settings.window_height(); }
};

Drawn draw(const std::string& scene, fas::Split split, int threads = 1) {
  RenderOptions options;
  options.fas_split = split;
  options.fas_choose = false;  // as for --fas-dump
  options.threads = threads;
  const Rendered rendered(scene, options);
  Drawn out;
  out.settings = rendered.settings;
  EXPECT_NE(rendered.renderer.eye_tree(), nullptr);
  if (!rendered.renderer.eye_tree()) return out;
  out.cells = tree_cells(*rendered.renderer.eye_tree(), rendered.renderer.camera(), rendered.settings);
  const fas::TreeCounts& counts = rendered.statistics().intersector.classes.at(0).in_tree;
  out.leaves_now = counts.leaves - counts.splits;
  return out;
}

TEST(TreeCellsTest, AreAsManyAsTheStatisticsSay) {
  for (const fas::Split split : {fas::Split::kAdaptive, fas::Split::kAlways}) {
    for (const int threads : {1, 3}) {
      const Drawn drawn = draw(crowd("screen 64 48 sample 3"), split, threads);
      EXPECT_GT(drawn.cells.visible.size(), 0u);
      EXPECT_EQ(drawn.cells.visible.size() + drawn.cells.outside, drawn.leaves_now);
    }
  }
}

/// With Split::kAlways every eye ray goes through the tree, so that every part of the window in which rays
/// are dense beside the cells has a leaf.
TEST(TreeCellsTest, TileTheWindow) {
  for (const char* view : {"screen 64 48 sample 4 contrast 0 0 0",
                           "screen 64 48 sample 4 contrast 0 0 0 "
                           "window 20 43 10 30"}) {
    const Drawn drawn = draw(crowd(view), fas::Split::kAlways);
    EXPECT_GT(drawn.cells.visible.size(), 10u);
    EXPECT_NEAR(drawn.area(), drawn.window(), 1e-6 * drawn.window()) << view;
  }
}

TEST(TreeCellsTest, EveryPixelIsInOneCell) {
  const Drawn drawn = draw(crowd("screen 64 48 sample 1 nojitter"), fas::Split::kAlways);
  EXPECT_LE(drawn.area(), drawn.window() * (1 + 1e-9));
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      int count = 0;
      for (const TreeCell& cell : drawn.cells.visible) count += holds(cell, x + .5, y + .5);
      ASSERT_EQ(count, 1) << x << ' ' << y;
    }
  }
}

/// Near a corner of the cube around the eye three faces meet on the screen.
TEST(TreeCellsTest, FacesMeetWithoutOverlap) {
  const Drawn drawn =
      draw(crowd("screen 64 64 sample 4 contrast 0 0 0", "eyep 5 -7 6 lookp 0 -2 1 fov 70 70"),
           fas::Split::kAlways);
  EXPECT_GT(drawn.area(), drawn.window() / 2);
  EXPECT_LE(drawn.area(), drawn.window() * (1 + 1e-9));
}

TEST(TreeCellsTest, OtherViewsHaveOneOrNone) {
  RenderOptions options;
  Rendered lens(crowd("screen 16 12 sample 1 aperture .1 focaldist 12"), options);
  EXPECT_EQ(lens.renderer.eye_tree(), nullptr);
  options.intersector = IntersectorKind::kHierarchy;
  EXPECT_EQ(Rendered(crowd("screen 16 12 sample 1"), options).renderer.eye_tree(), nullptr);
  EXPECT_EQ(Rendered("screen 8 8 sphere 1 0 0 0", {}).renderer.eye_tree(), nullptr);
}

}  // namespace
}  // namespace rayshade
