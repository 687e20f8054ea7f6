// SPDX-License-Identifier: MIT
// spd NAME [-s SIZE] [-f rayshade|nff|pov] [-o FILE]: writes one of the Standard Procedural Databases.
#include <charconv>
#include <fstream>
#include <iostream>
#include <optional>

#include "scenes/spd/databases.h"

namespace {

using rayshade::spd::Database;

struct Options {
  const Database* database = nullptr;
  int size = 0;
  std::string format = "rayshade";
  std::string file;  // empty: standard output
};

enum : int { kDone = 0, kFailed = 1, kWrongUsage = 2 };

void print_help(std::ostream& out) {
  out << "usage: spd NAME [-s SIZE] [-f rayshade|nff|pov] [-o FILE]\n"
         "Write a Standard Procedural Database, to standard output unless -o is given.\n\n"
         "  NAME    default and largest SIZE\n";
  for (const Database& d : rayshade::spd::databases())
    out << "  " << d.name << std::string(8 - d.name.size(), ' ') << d.default_size << ", " << d.largest_size
        << "\t" << d.what << '\n';
}

int misuse(const std::string& problem) {
  std::cerr << "spd: " << problem << "; try spd --help\n";
  return kWrongUsage;
}

std::optional<int> parse_size(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

int write(const Options& options) {
  std::ofstream file;
  if (!options.file.empty()) {
    file.open(options.file, std::ios::binary | std::ios::trunc);
    if (!file) {
      std::cerr << "spd: error: cannot write " << options.file << '\n';
      return kFailed;
    }
  }
  std::ostream& out = options.file.empty() ? std::cout : file;
  const auto writer = rayshade::spd::make_writer(options.format, out);
  options.database->generate(options.size, *writer);
  writer->finish();
  out.flush();
  if (!out) {
    std::cerr << "spd: error: cannot write " << (options.file.empty() ? "standard output" : options.file)
              << '\n';
    return kFailed;
  }
  return kDone;
}

int run(const std::vector<std::string>& arguments) {
  Options options;
  std::optional<std::string> size;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument == "-h" || argument == "--help") {
      print_help(std::cout);
      return kDone;
    }
    if (argument == "-s" || argument == "-f" || argument == "-o") {
      if (i + 1 == arguments.size()) return misuse("option " + argument + " needs a value");
      const std::string& value = arguments[++i];
      if (argument == "-s") size = value;
      if (argument == "-f") options.format = value;
      if (argument == "-o") options.file = value;
    } else if (argument.starts_with('-')) {
      return misuse("unknown option " + argument);
    } else if (options.database != nullptr) {
      return misuse("one database at a time, not also " + argument);
    } else if (options.database = rayshade::spd::find_database(argument); options.database == nullptr) {
      return misuse("no database is named " + argument);
    }
  }
  if (options.database == nullptr) return misuse("which database?");
  if (options.format != "rayshade" && options.format != "nff" && options.format != "pov")
    return misuse("no format is named " + options.format);
  options.size = options.database->default_size;
  if (size) {
    const std::optional<int> value = parse_size(*size);
    if (!value || *value < 1 || *value > options.database->largest_size)
      return misuse("the size of " + std::string(options.database->name) + " is a number from 1 to " +
                    std::to_string(options.database->largest_size) + ", not " + *size);
    options.size = *value;
  }
  return write(options);
}

}  // namespace

int main(int argc, char** argv) {
  std::ios::sync_with_stdio(false);
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << "spd: error: " << error.what() << '\n';
    return kFailed;
  }
}
