// SPDX-License-Identifier: MIT
// The reader of .checks files.
#include "tests/scene/check_file.h"

#include <algorithm>
#include <fstream>
#include <stdexcept>

namespace rayshade::checks {
namespace {

/// Splits the first word off; what is left begins with the next.
std::string first_word(std::string& text) {
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string word = text.substr(0, end);
  text.erase(0, std::min(text.find_first_not_of(' ', end), text.size()));
  return word;
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {}

  std::vector<Check> read() {
    std::ifstream in(file_);
    if (!in) fail("cannot be read");
    std::string line;
    while (std::getline(in, line)) {
      ++line_;
      if (line.empty() || line[0] == '#') continue;
      take(line);
    }
    finish();
    if (checks_.empty()) fail("has no checks");
    return std::move(checks_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw std::runtime_error(file_.string() + ":" + std::to_string(line_) + ": " + why);
  }

  void take(const std::string& line) {
    if (line.starts_with("| ")) return add_scene_line(line.substr(2));
    std::string rest = line;
    const std::string word = first_word(rest);
    if (word == "header") {
      finish();
      header_.clear();
      in_header_ = true;
    } else if (word == "check") {
      finish();
      in_header_ = false;
      open_ = true;
      check_ = {};
      check_.name = first_word(rest);
      check_.line = line_;
      lines_ = header_;
    } else if (!open_) {
      fail("\"" + word + "\" outside a check");
    } else if (word == "replace") {
      replaced_ = std::find(lines_.begin(), lines_.end(), rest);
      if (replaced_ == lines_.end()) fail("the header has no such line");
    } else if (word == "with") {
      *replaced_ = rest;
    } else if (word == "render") {
      check_.runs.push_back({rest, {}});
    } else if (check_.runs.empty()) {
      fail("an expectation before \"render\"");
    } else {
      check_.runs.back().expectations.push_back(line);
    }
  }

  void add_scene_line(const std::string& line) {
    if (in_header_) {
      header_.push_back(line);
    } else if (open_ && check_.runs.empty()) {
      lines_.push_back(line);
    } else {
      fail("a scene line outside a scene");
    }
  }

  void finish() {
    if (!open_) return;
    open_ = false;
    if (check_.runs.empty()) fail("the check before has no \"render\"");
    for (const std::string& line : lines_) check_.scene += line + "\n";
    checks_.push_back(std::move(check_));
  }

  std::filesystem::path file_;
  int line_ = 0;
  bool in_header_ = false, open_ = false;
  std::vector<std::string> header_, lines_;
  std::vector<std::string>::iterator replaced_;
  Check check_;
  std::vector<Check> checks_;
};

}  // namespace

std::vector<Check> read_checks(const std::filesystem::path& file) { return Reader(file).read(); }

}  // namespace rayshade::checks
