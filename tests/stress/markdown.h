// SPDX-License-Identifier: MIT
// Tables of measurements: Markdown on standard output, and in a file of their own where the environment
// variable RAYSHADE_TABLES names a folder (bench/run-accuracy puts them into docs/accuracy.md).
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

namespace rayshade::stress {

template <class... Arguments>
std::string format(const char* pattern, Arguments... arguments) {
  char text[400];
  std::snprintf(text, sizeof text, pattern, arguments...);
  return text;
}

/// `count` of the long versions times the environment variable RAYSHADE_STRESS, for a quick look or a long
/// night.
inline std::uint64_t scaled_count(double count) {
  const char* factor = std::getenv("RAYSHADE_STRESS");
  return static_cast<std::uint64_t>(count * (factor ? std::atof(factor) : 1)) + 1;
}

class Table {
 public:
  using Row = std::vector<std::string>;

  /// `name`: of the file, without suffix.
  Table(std::string name, const Row& head) : name_(std::move(name)) {
    add(head);
    add(Row(head.size(), "---"));
  }
  void add(const Row& row) {
    text_ += "|";
    for (const std::string& cell : row) text_ += " " + cell + " |";
    text_ += "\n";
  }
  ~Table() {
    std::printf("\n%s\n", text_.c_str());
    const char* folder = std::getenv("RAYSHADE_TABLES");
    if (folder) std::ofstream(std::string(folder) + "/" + name_ + ".md") << text_;
  }
  Table(const Table&) = delete;
  Table& operator=(const Table&) = delete;

 private:
  std::string name_, text_;
};

}  // namespace rayshade::stress
