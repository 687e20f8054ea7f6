// SPDX-License-Identifier: MIT
// Runs the built program in a folder of its own and keeps what it said.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace rayshade::testing_tools {

/// Limits of time are for a build as users have it; one with sanitizers is many times slower, and reserves
/// address space by the terabyte.
#ifdef RAYSHADE_SANITIZED
inline constexpr bool kSanitized = true;
inline constexpr int kTimeFactor = 10;
#else
inline constexpr bool kSanitized = false;
inline constexpr int kTimeFactor = 1;
#endif

inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

inline void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A folder that disappears with the object.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "rayshade-test-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("mkdtemp");
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct Outcome {
  int status = -1;  ///< exit code; 128 + signal where it was killed
  std::string out, err;
};

/// The program of this build, or the one that RAYSHADE_PROGRAM names.
inline std::string program() {
  const char* other = std::getenv("RAYSHADE_PROGRAM");
  return other ? other : std::string(BINARY_DIR) + "/bin/rayshade";
}

/// Runs `rayshade ARGUMENTS` (words as a shell reads them) in `folder`, killed after `seconds` times
/// kTimeFactor; `environment` goes before the command.
inline Outcome run(const std::filesystem::path& folder, const std::string& arguments,
                   const std::string& input = {}, int seconds = 60, const std::string& environment = {}) {
  write_file(folder / ".stdin", input);
  const std::string command = "cd '" + folder.string() + "' && " + environment + " timeout -k 1 " +
                              std::to_string(seconds * kTimeFactor) + " '" + program() + "' " + arguments +
                              " <.stdin >.stdout 2>.stderr";
  const int status = std::system(command.c_str());
  Outcome out;
  out.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  out.out = read_file(folder / ".stdout");
  out.err = read_file(folder / ".stderr");
  return out;
}

}  // namespace rayshade::testing_tools
