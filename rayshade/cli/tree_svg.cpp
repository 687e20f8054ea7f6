// SPDX-License-Identifier: MIT
#include "rayshade/cli/tree_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <iterator>

#include "rayshade/image/layer_picture.h"
#include "rayshade/image/writer.h"

namespace rayshade {
namespace {

constexpr std::int64_t kMostPixels = std::int64_t{1} << 25;

/// Cells with none, 1, 2, 3 to 4, 5 to 8 ... candidates look alike.
std::size_t shade_of(std::uint32_t candidates) {
  return candidates == 0 ? 0 : static_cast<std::size_t>(std::bit_width(candidates - 1)) + 1;
}

std::string range_of(std::size_t shade) {
  if (shade <= 2) return fmt::format("{}", shade);
  const std::uint32_t most = 1u << (shade - 1);
  return fmt::format("{}-{}", most / 2 + 1, most);
}

std::string color_of(std::size_t shade, std::size_t shades) {
  // The lightest colours would look like none.
  const double top = 0.85 / static_cast<double>(std::max<std::size_t>(shades, 2) - 1);
  const auto rgb = false_color(static_cast<double>(shade) * top);
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c >= ' ' && c <= '~' ? c : '?';
  }
  return out;
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

/// A float picture as its bytes would have been.
void copy_as_bytes(const FrameBuffer& picture, FrameBuffer& out) {
  const auto width = static_cast<std::size_t>(picture.width());
  std::vector<float> row(4 * width);
  std::vector<double> rgba(4 * width);
  for (std::int64_t y = 0; y < picture.height(); ++y) {
    picture.read_row(y, reinterpret_cast<std::uint8_t*>(row.data()));
    std::copy(row.begin(), row.end(), rgba.begin());
    out.put(PixelBlock{0, y, picture.width(), 1, rgba, {}});
  }
}

void draw_cells(const TreeCells& cells, std::size_t shades, double stroke, std::string& out) {
  std::vector<std::vector<const TreeCell*>> by_shade(shades);
  for (const TreeCell& cell : cells.visible) by_shade[shade_of(cell.candidates)].push_back(&cell);
  out += fmt::format(
      "<g id=\"cells\" fill-opacity=\"0.5\" stroke=\"#000000\" stroke-width=\"{:.4g}\" "
      "stroke-opacity=\"0.7\" stroke-linejoin=\"round\">\n",
      stroke);
  for (std::size_t shade = 0; shade < shades; ++shade) {
    if (by_shade[shade].empty()) continue;
    out += fmt::format("<g fill=\"{}\">\n", color_of(shade, shades));
    for (const TreeCell* cell : by_shade[shade]) {
      out += "<polygon points=\"";
      for (std::size_t i = 0; i < cell->corners.size(); ++i)
        out += fmt::format("{}{:.6g},{:.6g}", i == 0 ? "" : " ", cell->corners[i][0], cell->corners[i][1]);
      out +=
          fmt::format("\"><title>candidates {}, depth {}</title></polygon>\n", cell->candidates, cell->depth);
    }
    out += "</g>\n";
  }
  out += "</g>\n";
}

}  // namespace

std::string embeddable_png(const FrameBuffer& picture) {
  if (picture.width() * picture.height() > kMostPixels) return {};
  PictureInfo info;
  info.alpha = false;
  MemorySink png;
  switch (picture.storage()) {
    case PixelStorage::kByte:
      write_picture(picture, FileFormat::kPng8, info, png);
      break;
    case PixelStorage::kWord:
      write_picture(picture, FileFormat::kPng16, info, png);
      break;
    case PixelStorage::kFloat: {
      FrameBufferOptions options;
      options.width = picture.width();
      options.height = picture.height();
      options.encoding = picture.encoder().encoding();
      FrameBuffer bytes(options);
      copy_as_bytes(picture, bytes);
      write_picture(bytes, FileFormat::kPng8, info, png);
      break;
    }
    case PixelStorage::kExponential:
      break;
  }
  return png.bytes();
}

std::string tree_svg(const TreeCells& cells, const TreeDrawing& drawing, const std::string& png) {
  std::vector<std::uint64_t> counts;
  std::uint64_t candidates = 0;
  std::uint32_t most = 0;
  int deepest = 0;
  for (const TreeCell& cell : cells.visible) {
    const std::size_t shade = shade_of(cell.candidates);
    if (counts.size() <= shade) counts.resize(shade + 1);
    ++counts[shade];
    candidates += cell.candidates;
    most = std::max(most, cell.candidates);
    deepest = std::max(deepest, cell.depth);
  }
  const std::size_t count = cells.visible.size(), shades = std::max<std::size_t>(1, counts.size());
  const double mean = count == 0 ? 0 : static_cast<double>(candidates) / static_cast<double>(count);

  // All in pixels of the picture; the legend is as wide as the picture, whatever its size.
  const double width = drawing.width, height = drawing.height, em = width / 54;
  const int columns = 4, rows = (static_cast<int>(shades) + columns - 1) / columns;
  const double total = height + em * (6.2 + 1.7 * rows);
  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" "
      "version=\"1.1\" "
      "width=\"{0:.6g}\" height=\"{1:.6g}\" viewBox=\"0 0 {2:.6g} {3:.6g}\">\n",
      std::max(width, 640.0), total * std::max(1.0, 640 / width), width, total);
  out += fmt::format("<title>{}</title>\n<desc>{} cells, {} more outside of the window</desc>\n",
                     escaped(drawing.title), count, cells.outside);
  out += fmt::format("<rect width=\"{:.6g}\" height=\"{:.6g}\" fill=\"#ffffff\"/>\n", width, total);
  if (!png.empty()) {
    out +=
        fmt::format("<image width=\"{:.6g}\" height=\"{:.6g}\" xlink:href=\"data:image/png;base64,{}\"/>\n",
                    width, height, base64(png));
  }
  draw_cells(cells, shades, em / 40, out);
  double y = height + 1.8 * em;
  out +=
      fmt::format("<g id=\"legend\" font-family=\"sans-serif\" font-size=\"{:.6g}\" fill=\"#000000\">\n", em);
  const auto text = [&](double x, const std::string& words) {
    out += fmt::format("<text x=\"{:.6g}\" y=\"{:.6g}\">{}</text>\n", x, y, escaped(words));
  };
  text(em, drawing.title);
  y += 1.4 * em;
  text(em,
       fmt::format(
           "{} cells ({} more outside of the window), {:.1f} candidates in the mean, {} at most; depth at "
           "most {}",
           count, cells.outside, mean, most, deepest));
  y += 1.4 * em;
  text(em, drawing.note + (png.empty() ? " The picture cannot be shown beneath." : ""));
  for (std::size_t shade = 0; shade < counts.size(); ++shade) {
    if (shade % columns == 0) y += 1.7 * em;
    const double x = em + static_cast<double>(shade % columns) * 13 * em;
    out += fmt::format(
        "<rect x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.6g}\" height=\"{:.6g}\" fill=\"{}\" "
        "fill-opacity=\"0.8\" stroke=\"#000000\" stroke-width=\"{:.4g}\"/>\n",
        x, y - 0.85 * em, 2 * em, em, color_of(shade, shades), em / 20);
    text(x + 2.6 * em,
         fmt::format("{}: {} cell{}", range_of(shade), counts[shade], counts[shade] == 1 ? "" : "s"));
  }
  out += "</g>\n</svg>\n";
  return out;
}

}  // namespace rayshade
