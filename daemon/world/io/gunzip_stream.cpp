#include "daemon/world/io/gunzip_stream.hpp"

#include <zlib.h>

#include <algorithm>
#include <string>

namespace thimble::world {
namespace {

constexpr int kGzipOnly = 15 + 16;  // zlib.h, inflateInit2: window of 32 KiB, gzip's header
// RFC 1952, ID1 and ID2: zlib refuses what does not begin with them before it takes a third byte.
constexpr uLong kMagicBytes = 2;

[[nodiscard]] tl::unexpected<Error> refused(int code, const char* why) {
  if (code == Z_MEM_ERROR) return fail(Errc::System, "data: gzip: out of memory");
  return fail(Errc::Malformed, std::string("data: gzip: ") + (why != nullptr ? why : "is damaged"));
}

}  // namespace

struct GunzipStream::State {
  z_stream stream{};
  bool is_open{false};     // inflateInit2() worked
  bool is_within{false};   // a member has begun and not ended
  bool has_member{false};  // one has ended
};

GunzipStream::GunzipStream(BufferedSource& packed)
    : packed_(packed), state_(std::make_unique<State>()) {}

GunzipStream::~GunzipStream() {
  if (state_->is_open) inflateEnd(&state_->stream);
}

// False at the end.
Result<bool> GunzipStream::begin_member() {
  const auto ahead = packed_.peek();
  if (!ahead) return tl::unexpected(ahead.error());
  if (ahead->empty() && state_->is_open) return false;
  z_stream& stream = state_->stream;
  const int code = state_->is_open ? inflateReset(&stream) : inflateInit2(&stream, kGzipOnly);
  if (code != Z_OK) return refused(code, stream.msg);
  state_->is_open = state_->is_within = true;
  return true;
}

Result<std::size_t> GunzipStream::read(std::span<std::byte> out) {
  z_stream& stream = state_->stream;
  std::size_t done = 0;
  while (done < out.size()) {
    if (!state_->is_within) {
      const auto more = begin_member();
      if (!more) return tl::unexpected(more.error());
      if (!*more) return done;
    }
    const auto ahead = packed_.peek();
    if (!ahead) return tl::unexpected(ahead.error());
    if (ahead->empty()) return fail(Errc::Malformed, "data: gzip: the file ends within it");
    // zlib reads from next_in only; its type is older than const.
    stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(ahead->data()));
    stream.avail_in = static_cast<uInt>(ahead->size());
    const std::size_t room = std::min<std::size_t>(out.size() - done, 1U << 30);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + done);
    stream.avail_out = static_cast<uInt>(room);
    const int code = inflate(&stream, Z_NO_FLUSH);
    packed_.take(ahead->size() - stream.avail_in);
    done += room - stream.avail_out;
    if (code == Z_STREAM_END) {
      state_->is_within = false;
      state_->has_member = true;
    } else if (code == Z_DATA_ERROR && state_->has_member && stream.total_in <= kMagicBytes) {
      return fail(Errc::Malformed, "data: gzip: other bytes follow behind its end");
    } else if (code != Z_OK) {
      return refused(code, stream.msg);
    }
  }
  return done;
}

}  // namespace thimble::world
