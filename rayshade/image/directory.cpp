// SPDX-License-Identifier: MIT
#include "rayshade/image/directory.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <string_view>

namespace rayshade {
namespace {

constexpr std::string_view kSuffix = ".tmp";

/// File names end at 255 bytes; the hidden one is longer than the final one.
std::string shown_name(const std::string& target) { return target.substr(directory_of(target).size(), 200); }

std::string host_mark() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) name[0] = '\0';
  const std::string_view text(name.data());
  return fmt::format("{:08x}",
                     crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size())));
}

/// Takes the last of the parts that dots divide off `name`.
std::string_view take_last(std::string_view& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos) return {};
  const std::string_view part = name.substr(dot + 1);
  name.remove_suffix(part.size() + 1);
  return part;
}

/// A number as fmt writes it, nothing where it is none.
std::optional<int> number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || fmt::format("{}", value) != text) return {};
  return value;
}

bool lives(int process) { return process != getpid() && (kill(process, 0) == 0 || errno != ESRCH); }

/// Whether `name` is a temporary_name of one of the targets of its folder, and of a dead process of this
/// host.
bool is_leftover(std::string_view name, const std::set<std::string, std::less<>>& shown,
                 const std::string& host) {
  if (!name.starts_with('.') || !name.ends_with(kSuffix)) return false;
  name.remove_prefix(1);
  name.remove_suffix(kSuffix.size());
  const std::optional<int> attempt = number(take_last(name));
  const std::optional<int> process = number(take_last(name));
  return attempt && *attempt >= 0 && process && *process > 0 && take_last(name) == host &&
         shown.contains(name) && !lives(*process);
}

struct CloseFolder {
  void operator()(DIR* folder) const { closedir(folder); }
};

}  // namespace

std::string directory_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? std::string() : path.substr(0, slash + 1);
}

std::string follow_links(std::string path) {
  for (int depth = 0; depth < 40; ++depth) {
    char link[4096];
    const ssize_t length = ::readlink(path.c_str(), link, sizeof link);
    if (length < 0 || length == static_cast<ssize_t>(sizeof link)) return path;
    const std::string to(link, static_cast<std::size_t>(length));
    const std::size_t slash = path.rfind('/');
    path.resize(to.starts_with('/') || slash == std::string::npos ? 0 : slash + 1);
    path.append(to);
  }
  return path;
}

std::string temporary_name(const std::string& target, int attempt) {
  return fmt::format("{}.{}.{}.{}.{}{}", directory_of(target), shown_name(target), host_mark(), getpid(),
                     attempt, kSuffix);
}

int remove_leftovers(const std::vector<std::string>& targets) noexcept {
  int removed = 0;
  try {
    std::map<std::string, std::set<std::string, std::less<>>> shown;
    for (const std::string& target : targets) {
      const std::string followed = follow_links(target);
      shown[directory_of(followed)].insert(shown_name(followed));
    }
    const std::string host = host_mark();
    for (const auto& [directory, names] : shown) {
      const std::unique_ptr<DIR, CloseFolder> folder(opendir(directory.empty() ? "." : directory.c_str()));
      if (!folder) continue;
      const int in = dirfd(folder.get());
      while (const dirent* entry = readdir(folder.get())) {
        struct stat info {};
        if (is_leftover(entry->d_name, names, host) &&
            fstatat(in, entry->d_name, &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(info.st_mode))
          removed += unlinkat(in, entry->d_name, 0) == 0;
      }
    }
  } catch (const std::bad_alloc&) {
    return removed;
  }
  return removed;
}

bool sync_directory_of(const std::string& path) {
  const std::string directory = directory_of(path);
  const int folder = open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return false;
  const bool done = fsync(folder) == 0;
  close(folder);
  return done;
}

}  // namespace rayshade
