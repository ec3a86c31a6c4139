#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>

namespace thimble::world {

// `plain` in gzip's format.
inline std::string gzipped(const std::string& plain) {
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, plain.size()) + 64, '\0');
  std::string in = plain;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

// An NRRD file as its definition says it, independent of our parser.
struct NrrdBytes {
  std::string type = "uchar";
  std::string sizes = "2 3 4";
  std::string encoding = "raw";
  std::string more;  // further lines
  std::string data = std::string(24, '\0');

  [[nodiscard]] std::string header() const {
    return "NRRD0004\n# made by a test\ntype: " + type + "\ndimension: 3\nsizes: " + sizes +
           "\nencoding: " + encoding + "\n" + more + "\n";
  }
  [[nodiscard]] std::string file() const { return header() + data; }
};

}  // namespace thimble::world
