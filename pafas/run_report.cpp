// SPDX-License-Identifier: MIT
#include "pafas/run_report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "rayshade/cli/json.h"
#include "rayshade/image/output_file.h"
#include "rayshade/image/writer.h"

namespace pafas {
namespace {

constexpr std::string_view kMarks = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
/// Tilings of more columns are for pictures, not for terminals.
constexpr std::size_t kMostColumns = 128;

char mark_of(int rank) {
  return rank < static_cast<int>(kMarks.size()) ? kMarks[static_cast<std::size_t>(rank)] : '*';
}

/// Colours that neighbours in number do not share: hues by the golden ratio, in two lightnesses.
std::array<double, 3> color_of(int rank) {
  const double hue = 6 * (0.6180339887498949 * rank - static_cast<int>(0.6180339887498949 * rank));
  const double light = rank % 2 == 0 ? .92 : .68, low = .25 * light;
  const auto channel = [&](double shift) {
    double h = hue + shift;
    if (h >= 6) h -= 6;
    const double t = h < 1 ? h : h < 3 ? 1 : h < 4 ? 4 - h : 0;
    return low + (light - low) * t;
  };
  return {channel(2), channel(0), channel(4)};
}

std::string hex_color(int rank) {
  const auto c = color_of(rank);
  return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(255 * c[0]), static_cast<int>(255 * c[1]),
                     static_cast<int>(255 * c[2]));
}

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

}  // namespace

std::string RunReport::host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::string RunReport::text(bool verbose) const {
  if (rows.size() < 2) return {};
  std::string out = fmt::format("\n{} ranks, schedule {}; {} blocks rendered twice, {} ranks lost\n",
                                rows.size(), schedule, repeated_blocks, lost_ranks);
  out += fmt::format("{:>5} {:>7} {:>8} {:>12} {:>9} {:>9} {:>10} {:>9} {:>9}  {}\n", "rank", "threads",
                     "blocks", "rays", "CPU s", "wait s", "tree nodes", "trees MB", "memory MB", "host");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RankRow& row = rows[i];
    out += fmt::format("{:>5} {:>7} {:>8} ", i, row.report.threads, row.blocks);
    if (row.reported)
      out += fmt::format("{:>12} {:>9.2f} {:>9.2f} {:>10} {:>9.2f} {:>9.1f}  {}\n", row.report.rays(),
                         row.report.cpu_seconds, row.report.wait_seconds, row.report.tree_nodes(),
                         megabytes(row.report.tree_bytes()), megabytes(row.report.peak_memory), row.host);
    else
      out += fmt::format("{:>12} {:>9.2f} {:>9} {:>10} {:>9} {:>9}  {} ({})\n", "-", row.render_seconds, "-",
                         "-", "-", "-", row.host, row.outcome);
  }
  if (verbose && !spans.empty()) out += "\n" + tiling(spans.back().frame);
  return out;
}

void RunReport::write_json(rayshade::JsonWriter& j) const {
  j.begin_object("cluster");
  j.value("schedule", schedule).value("ranks_lost", lost_ranks).value("blocks_repeated", repeated_blocks);
  j.value("package_bytes", package_bytes);
  j.begin_array("ranks");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RankRow& row = rows[i];
    j.begin_object();
    j.value("rank", static_cast<int>(i))
        .value("host", row.host)
        .value("process", std::to_string(row.process));
    j.value("outcome", row.outcome).value("threads", static_cast<int>(row.report.threads));
    j.value("blocks", row.blocks).value("blocks_rendered", row.report.blocks);
    j.value("block_seconds", row.render_seconds).value("compile_seconds", row.report.compile_seconds);
    j.value("messages_received", row.messages).value("bytes_received", row.bytes);
    if (row.reported) {
      j.value("rays", row.report.rays()).value("cpu_seconds", row.report.cpu_seconds);
      j.value("wait_seconds", row.report.wait_seconds).value("tree_nodes", row.report.tree_nodes());
      j.value("tree_bytes", row.report.tree_bytes()).value("peak_memory_bytes", row.report.peak_memory);
    }
    j.end_object();
  }
  j.end_array();
  j.end_object();
}

std::string RunReport::tiling(int frame) const {
  // Characters stand for cells as large as the smallest block, or larger where the picture has too many.
  int cell = std::max(width, height);
  for (const BlockSpan& span : spans)
    if (span.counted && span.frame == frame)
      cell = std::min(cell, std::max(1, std::min(span.block.width, span.block.height)));
  cell = std::max(cell, (width - 1) / static_cast<int>(kMostColumns) + 1);
  const int columns = (width - 1) / cell + 1, lines = (height - 1) / cell + 1;
  std::vector<std::string> rows_out(static_cast<std::size_t>(lines),
                                    std::string(static_cast<std::size_t>(columns), '.'));
  for (const BlockSpan& span : spans) {
    if (!span.counted || span.frame != frame) continue;
    const rayshade::Block& b = span.block;
    for (int y = b.y / cell; y <= (b.y + b.height - 1) / cell; ++y)
      for (int x = b.x / cell; x <= (b.x + b.width - 1) / cell; ++x)
        rows_out[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = mark_of(span.rank);
  }
  std::string out;
  for (const std::string& row : rows_out) out += row + "\n";
  return out;
}

void RunReport::write_tile_map(const std::string& path, int frame) const {
  rayshade::FrameBufferOptions options;
  options.width = width;
  options.height = height;
  rayshade::FrameBuffer map(options);
  std::vector<double> rgba;
  for (const BlockSpan& span : spans) {
    if (!span.counted || span.frame != frame) continue;
    const rayshade::Block& b = span.block;
    const auto color = color_of(span.rank);
    rgba.clear();
    for (int y = 0; y < b.height; ++y)
      for (int x = 0; x < b.width; ++x) {
        // A darker edge keeps blocks of one rank apart.
        const double shade = (x == 0 || y == 0) && b.width > 2 && b.height > 2 ? .8 : 1;
        rgba.insert(rgba.end(), {shade * color[0], shade * color[1], shade * color[2], 1});
      }
    map.put(rayshade::PixelBlock{b.x, b.y, b.width, b.height, rgba, {}});
  }
  rayshade::OutputFile file(path);
  rayshade::write_picture(map, rayshade::FileFormat::kPng8, {}, file);
  file.commit();
}

std::string RunReport::timeline() const {
  constexpr double kWidth = 1200, kRow = 14, kLeft = 90, kTop = 24;
  double first = 0, last = 1e-9;
  if (!spans.empty()) first = spans.front().begin;
  for (const BlockSpan& span : spans) {
    first = std::min(first, span.begin);
    last = std::max(last, span.end);
  }
  const double scale = kWidth / std::max(last - first, 1e-9);
  const double bottom = kTop + kRow * static_cast<double>(rows.size()) + 30;
  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"10\">\n"
      "<title>Blocks of {2} ranks over time</title>\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "fill=\"#ffffff\"/>\n",
      kLeft + kWidth + 10, bottom, rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    out += fmt::format("<text x=\"4\" y=\"{:.1f}\">{}</text>\n", kTop + kRow * (static_cast<double>(i) + .75),
                       fmt::format("rank {}", i));
  for (const BlockSpan& span : spans) {
    out += fmt::format(
        "<rect x=\"{:.2f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"{:.1f}\" fill=\"{}\" stroke=\"#ffffff\" "
        "stroke-width=\".3\"{}/>\n",
        kLeft + scale * (span.begin - first), kTop + kRow * span.rank + 1,
        std::max(scale * (span.end - span.begin), .2), kRow - 2, hex_color(span.rank),
        span.counted ? "" : " fill-opacity=\".35\"");
  }
  out += fmt::format(
      "<text x=\"{:.0f}\" y=\"{:.0f}\">0 s</text>\n<text x=\"{:.0f}\" y=\"{:.0f}\" "
      "text-anchor=\"end\">{:.2f} s (pale: another rank's result came first)</text>\n</svg>\n",
      kLeft, bottom - 10, kLeft + kWidth, bottom - 10, last - first);
  return out;
}

}  // namespace pafas
