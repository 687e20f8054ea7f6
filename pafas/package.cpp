// SPDX-License-Identifier: MIT
#include "pafas/package.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "pafas/archive.h"

namespace pafas {
namespace {

struct File {
  std::string name, content;
};

template <class Archive>
void fields(Archive& a, File& file) {
  a(file.name, file.content);
}

/// zlib counts in 32 bits.
constexpr std::size_t kStep = std::size_t{1} << 30;

std::string compressed(const std::string& bytes) {
  z_stream stream{};
  if (deflateInit(&stream, 1) != Z_OK) throw std::bad_alloc();
  std::string out;
  std::string room(std::size_t{1} << 18, '\0');
  std::size_t used = 0;
  int state = Z_OK;
  while (state != Z_STREAM_END) {
    const std::size_t step = std::min(bytes.size() - used, kStep);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + used));
    stream.avail_in = static_cast<uInt>(step);
    used += step;
    do {
      stream.next_out = reinterpret_cast<Bytef*>(room.data());
      stream.avail_out = static_cast<uInt>(room.size());
      state = deflate(&stream, used == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
      out.append(room.data(), room.size() - stream.avail_out);
    } while (stream.avail_out == 0);
  }
  deflateEnd(&stream);
  return out;
}

std::string restored(std::string_view bytes, std::uint64_t size) {
  // Deflate makes nothing smaller than by this factor: a length that cannot be is refused before it is taken.
  if (size / 1100 > bytes.size()) throw ArchiveError("a package of an impossible length");
  std::string out(static_cast<std::size_t>(size), '\0');
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  std::size_t in = 0, made = 0;
  int state = Z_OK;
  while (state == Z_OK) {
    const std::size_t step = std::min(bytes.size() - in, kStep), room = std::min(out.size() - made, kStep);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + in));
    stream.avail_in = static_cast<uInt>(step);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + made);
    stream.avail_out = static_cast<uInt>(room);
    state = inflate(&stream, Z_NO_FLUSH);
    in += step - stream.avail_in;
    made += room - stream.avail_out;
  }
  inflateEnd(&stream);
  if (state != Z_STREAM_END || made != out.size()) throw ArchiveError("a package that cannot be unpacked");
  return out;
}

struct Package {
  std::uint64_t size = 0;
  std::string compressed;
};

template <class Archive>
void fields(Archive& a, Package& package) {
  a(package.size, package.compressed);
}

}  // namespace

rayshade::Bytes RecordingProvider::read(const std::string& name) {
  rayshade::Bytes bytes = files_.read(name);
  const std::lock_guard lock(mutex_);
  read_[name] = bytes;
  return bytes;
}

std::string RecordingProvider::package() const {
  std::vector<File> files;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, bytes] : read_) files.push_back({name, *bytes});
  }
  const std::string plain = to_bytes(files);
  return to_bytes(Package{plain.size(), compressed(plain)});
}

void RecordingProvider::forget() {
  const std::lock_guard lock(mutex_);
  read_.clear();
}

void unpack_files(std::string_view bytes, rayshade::MemoryProvider& into) {
  const auto package = from_bytes<Package>(bytes);
  for (File& file : from_bytes<std::vector<File>>(restored(package.compressed, package.size)))
    into.add(std::move(file.name), std::move(file.content));
}

}  // namespace pafas
