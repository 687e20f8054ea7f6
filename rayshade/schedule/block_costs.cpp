// SPDX-License-Identifier: MIT
#include "rayshade/schedule/block_costs.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numeric>
#include <system_error>

namespace rayshade {
namespace {

constexpr std::string_view kTitle = "rayshade-block-costs";
constexpr int kVersion = 1;
constexpr int kMostPixels = 1 << 24;  ///< per side

std::string shortest(double number) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, number);
  return {text, end.ptr};
}

/// Words line by line, and the errors that they give rise to.
class Reader {
 public:
  Reader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw BlockCostsError(name_ + ":" + std::to_string(line_) + ": " + what);
  }
  /// The words of the next line that holds any; none at the end.
  std::vector<std::string_view> line() {
    std::vector<std::string_view> words;
    while (words.empty() && !text_.empty()) {
      ++line_;
      const std::size_t end = text_.find('\n');
      std::string_view rest = text_.substr(0, end);
      text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
      if (rest.starts_with('#')) continue;
      while (true) {
        const std::size_t first = rest.find_first_not_of(" \t\r");
        if (first == std::string_view::npos) break;
        const std::size_t last = std::min(rest.find_first_of(" \t\r", first), rest.size());
        words.push_back(rest.substr(first, last - first));
        rest.remove_prefix(last);
      }
    }
    return words;
  }
  template <class T>
  T number(std::string_view word, T lowest, T highest, const char* what) const {
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || !(value >= lowest && value <= highest))
      fail(std::string(what) + ": '" + std::string(word) + "' is no number from " + std::to_string(lowest) +
           " to " + std::to_string(highest));
    return value;
  }

 private:
  std::string_view text_;
  const std::string& name_;
  int line_ = 0;
};

void read_block(const Reader& reader, const std::vector<std::string_view>& words, BlockCosts& costs) {
  if (words.size() != 6) reader.fail("a block has six numbers: number x y width height seconds");
  Block block;
  block.number = reader.number<std::int64_t>(words[0], 0, std::int64_t{1} << 50, "number");
  block.x = reader.number<int>(words[1], 0, costs.width - 1, "x");
  block.y = reader.number<int>(words[2], 0, costs.height - 1, "y");
  block.width = reader.number<int>(words[3], 1, costs.width - block.x, "width");
  block.height = reader.number<int>(words[4], 1, costs.height - block.y, "height");
  costs.blocks.push_back(block);
  costs.seconds.push_back(reader.number<double>(words[5], 0, 1e9, "seconds"));
}

/// Whether the blocks cover every pixel once.
bool tiles(const BlockCosts& costs) {
  std::int64_t area = 0;
  for (const Block& block : costs.blocks) area += block.pixels();
  if (area != std::int64_t{costs.width} * costs.height) return false;
  // Equal areas, so there is a gap if and only if two overlap: sweep over rows, marking covered columns.
  std::vector<std::size_t> order(costs.blocks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Block &p = costs.blocks[a], &q = costs.blocks[b];
    return p.y != q.y ? p.y < q.y : p.x < q.x;
  });
  std::vector<int> covered_to(static_cast<std::size_t>(costs.width));
  for (const std::size_t i : order) {
    const Block& block = costs.blocks[i];
    for (int x = block.x; x < block.x + block.width; ++x) {
      int& to = covered_to[static_cast<std::size_t>(x)];
      if (to != block.y) return false;
      to += block.height;
    }
  }
  return true;
}

}  // namespace

double BlockCosts::total_seconds() const { return std::accumulate(seconds.begin(), seconds.end(), 0.0); }

std::string format_block_costs(const BlockCosts& costs) {
  std::string out = std::string(kTitle) + " " + std::to_string(kVersion) + "\n";
  const auto line = [&out](const char* key, const std::string& value) { out += key + (" " + value) + "\n"; };
  line("width", std::to_string(costs.width));
  line("height", std::to_string(costs.height));
  line("side", std::to_string(costs.side));
  line("samples", std::to_string(costs.samples));
  line("tree-fixed-seconds", shortest(costs.tree_fixed_seconds));
  line("tree-region-seconds", shortest(costs.tree_region_seconds));
  line("scene-bytes", std::to_string(costs.scene_bytes));
  line("compile-seconds", shortest(costs.compile_seconds));
  line("result-bytes-per-pixel", shortest(costs.result_bytes_per_pixel));
  line("blocks", std::to_string(costs.blocks.size()));
  for (std::size_t i = 0; i < costs.blocks.size(); ++i) {
    const Block& b = costs.blocks[i];
    for (const std::int64_t number :
         {b.number, std::int64_t{b.x}, std::int64_t{b.y}, std::int64_t{b.width}, std::int64_t{b.height}})
      out += std::to_string(number) + " ";
    out += shortest(costs.seconds[i]) + "\n";
  }
  return out;
}

BlockCosts parse_block_costs(std::string_view text, const std::string& name) {
  Reader reader(text, name);
  auto words = reader.line();
  if (words.size() != 2 || words[0] != kTitle) reader.fail("this is no file of block costs");
  if (reader.number<int>(words[1], 1, 1'000'000, "version") != kVersion)
    reader.fail("version " + std::string(words[1]) + " of block costs is not known");
  BlockCosts costs;
  std::int64_t blocks = -1;
  while (blocks < 0) {
    words = reader.line();
    if (words.empty()) reader.fail("the head ends without 'blocks'");
    if (words.size() != 2) reader.fail("expected a name and a number");
    const std::string_view key = words[0], value = words[1];
    if (key == "width")
      costs.width = reader.number<int>(value, 1, kMostPixels, "width");
    else if (key == "height")
      costs.height = reader.number<int>(value, 1, kMostPixels, "height");
    else if (key == "side")
      costs.side = reader.number<int>(value, 0, kMostPixels, "side");
    else if (key == "samples")
      costs.samples = reader.number<int>(value, 1, 1000, "samples");
    else if (key == "tree-fixed-seconds")
      costs.tree_fixed_seconds = reader.number<double>(value, 0, 1e9, "tree-fixed-seconds");
    else if (key == "tree-region-seconds")
      costs.tree_region_seconds = reader.number<double>(value, 0, 1e9, "tree-region-seconds");
    else if (key == "scene-bytes")
      costs.scene_bytes = reader.number<std::uint64_t>(value, 0, std::uint64_t{1} << 50, "scene-bytes");
    else if (key == "compile-seconds")
      costs.compile_seconds = reader.number<double>(value, 0, 1e9, "compile-seconds");
    else if (key == "result-bytes-per-pixel")
      costs.result_bytes_per_pixel = reader.number<double>(value, 0, 1e6, "result-bytes-per-pixel");
    else if (key == "blocks")
      blocks = reader.number<std::int64_t>(value, 1, std::int64_t{1} << 40, "blocks");
    else
      reader.fail("unknown entry '" + std::string(key) + "'");
  }
  if (costs.width == 0 || costs.height == 0) reader.fail("width and height are missing");
  for (std::int64_t i = 0; i < blocks; ++i) {
    words = reader.line();
    if (words.empty())
      reader.fail("the file ends after " + std::to_string(i) + " of " + std::to_string(blocks) + " blocks");
    read_block(reader, words, costs);
  }
  if (!reader.line().empty()) reader.fail("more blocks than the head says");
  if (!tiles(costs)) reader.fail("the blocks do not tile the picture");
  return costs;
}

BlockCosts read_block_costs(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) throw BlockCostsError(path + ": cannot be read");
  return parse_block_costs(text, path);
}

void write_block_costs(const BlockCosts& costs, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << format_block_costs(costs);
  file.close();
  if (!file) throw BlockCostsError(path + ": cannot be written");
}

std::vector<double> redistribute(const BlockCosts& costs, const BlockGrid& grid) {
  std::vector<double> out(static_cast<std::size_t>(grid.count()));
  for (std::size_t i = 0; i < costs.blocks.size(); ++i) {
    const Block& from = costs.blocks[i];
    const double per_pixel = costs.seconds[i] / static_cast<double>(from.pixels());
    const int first_column = from.x / grid.block_width(), first_row = from.y / grid.block_height();
    const int last_column = (from.x + from.width - 1) / grid.block_width();
    const int last_row = (from.y + from.height - 1) / grid.block_height();
    for (int row = first_row; row <= last_row; ++row) {
      for (int column = first_column; column <= last_column; ++column) {
        const std::int64_t number = std::int64_t{row} * grid.columns() + column;
        const Block to = grid.block(number);
        const int width = std::min(from.x + from.width, to.x + to.width) - std::max(from.x, to.x);
        const int height = std::min(from.y + from.height, to.y + to.height) - std::max(from.y, to.y);
        out[static_cast<std::size_t>(number)] += per_pixel * width * height;
      }
    }
  }
  return out;
}

BlockCosts enlarged(BlockCosts costs, int factor) {
  costs.width *= factor;
  costs.height *= factor;
  costs.side *= factor;
  for (Block& block : costs.blocks) {
    block.x *= factor;
    block.y *= factor;
    block.width *= factor;
    block.height *= factor;
  }
  for (double& seconds : costs.seconds) seconds *= static_cast<double>(factor) * factor;
  return costs;
}

}  // namespace rayshade
