#include <zlib.h>

#include "cli/picture/picture.hpp"
#include "hal/base/check.hpp"

namespace thimble::picture {
namespace {

void add_big_endian(std::string& to, std::size_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) to += static_cast<char>(number >> shift & 0xff);
}

void add_chunk(std::string& to, const std::string& type, const std::string& data) {
  add_big_endian(to, data.size());
  const std::string sealed = type + data;
  to += sealed;
  add_big_endian(to, ::crc32(0, reinterpret_cast<const Bytef*>(sealed.data()),
                             static_cast<uInt>(sealed.size())));
}

// Each row behind a byte that says how it is filtered: not at all.
std::string compressed(const Picture& picture) {
  std::string rows;
  rows.reserve(picture.height * (3 * picture.width + 1));
  for (std::size_t row = 0; row < picture.height; ++row) {
    rows += '\0';
    const auto* from = reinterpret_cast<const char*>(picture.rgb.data()) + 3 * picture.width * row;
    rows.append(from, 3 * picture.width);
  }
  uLongf size = ::compressBound(static_cast<uLong>(rows.size()));
  std::string out(size, '\0');
  // With room for the worst, memory is all that could be wanting.
  THIMBLE_CHECK(::compress(reinterpret_cast<Bytef*>(out.data()), &size,
                           reinterpret_cast<const Bytef*>(rows.data()),
                           static_cast<uLong>(rows.size())) == Z_OK);
  out.resize(size);
  return out;
}

}  // namespace

std::string to_png(const Picture& picture) {
  std::string file("\x89PNG\r\n\x1a\n");
  std::string header;
  add_big_endian(header, picture.width);
  add_big_endian(header, picture.height);
  // 8 bits a channel, red, green and blue; deflated, filtered by rows, not interlaced.
  header += std::string("\x08\x02\x00\x00\x00", 5);
  add_chunk(file, "IHDR", header);
  add_chunk(file, "IDAT", compressed(picture));
  add_chunk(file, "IEND", "");
  return file;
}

}  // namespace thimble::picture
