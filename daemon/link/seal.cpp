#include "daemon/link/seal.hpp"

#include <sodium.h>

#include <algorithm>
#include <string_view>

#include "daemon/link/network_bytes.hpp"
#include "hal/base/check.hpp"

namespace thimble::link {
namespace {

constexpr std::size_t kTag = crypto_aead_chacha20poly1305_IETF_ABYTES;
constexpr std::size_t kHandshakeNonce = crypto_aead_xchacha20poly1305_ietf_NPUBBYTES;
static_assert(kTag == crypto_aead_xchacha20poly1305_ietf_ABYTES);
static_assert(kTag + kHandshakeNonce == kMaxSealOverhead);
static_assert(crypto_aead_chacha20poly1305_IETF_KEYBYTES == 32 &&
              crypto_aead_xchacha20poly1305_ietf_KEYBYTES == 32);

unsigned char* raw(std::byte* bytes) noexcept { return reinterpret_cast<unsigned char*>(bytes); }
const unsigned char* raw(const std::byte* bytes) noexcept {
  return reinterpret_cast<const unsigned char*>(bytes);
}

// Chooses the fastest code for this machine; the first call counts, and any thread may make it.
void start_library() noexcept { THIMBLE_CHECK(sodium_init() >= 0); }

using Halves = std::array<std::byte, crypto_generichash_BYTES_MAX>;

class Derivation {
 public:
  Derivation(const LinkKey& key, std::string_view purpose) noexcept {
    start_library();
    crypto_generichash_init(&state_, raw(key.bytes().data()), LinkKey::kSize, sizeof(Halves));
    add(std::as_bytes(std::span(purpose)));
  }
  void add(std::span<const std::byte> bytes) noexcept {
    crypto_generichash_update(&state_, raw(bytes.data()), bytes.size());
  }
  [[nodiscard]] Halves finish() noexcept {
    Halves halves{};
    crypto_generichash_final(&state_, raw(halves.data()), halves.size());
    sodium_memzero(&state_, sizeof state_);
    return halves;
  }

 private:
  crypto_generichash_state state_{};
};

std::span<const std::byte, 32> half_of(const Halves& halves, Towards towards) noexcept {
  return towards == Towards::World ? std::span(halves).first<32>() : std::span(halves).last<32>();
}

using SessionNonce = std::array<std::byte, crypto_aead_chacha20poly1305_IETF_NPUBBYTES>;
SessionNonce nonce_of(std::uint64_t sequence) noexcept {
  SessionNonce nonce{};
  ByteWriter writer{std::span(nonce).last<8>()};
  writer.values(sequence);
  return nonce;
}

}  // namespace

RandomBytes system_random() {
  start_library();
  return [](std::span<std::byte> out) { randombytes_buf(out.data(), out.size()); };
}

Nonce keyed_sum(const LinkKey& key, std::span<const std::byte> text) noexcept {
  start_library();
  Nonce sum{};
  crypto_generichash(raw(sum.data()), sum.size(), raw(text.data()), text.size(),
                     raw(key.bytes().data()), LinkKey::kSize);
  return sum;
}

Seal::Seal(Kind kind, std::span<const std::byte, kKeySize> key) noexcept : kind_(kind) {
  std::copy(key.begin(), key.end(), key_.begin());
}

Seal::~Seal() { sodium_memzero(key_.data(), key_.size()); }

Seal Seal::of_handshake(const LinkKey& key, Towards towards) noexcept {
  Halves halves = Derivation(key, "thimble 1 handshake").finish();
  Seal seal(Kind::Handshake, half_of(halves, towards));
  sodium_memzero(halves.data(), halves.size());
  return seal;
}

Seal Seal::of_session(const LinkKey& key, Towards towards, const Nonce& arm, const Nonce& world,
                      std::uint64_t session) noexcept {
  Derivation derivation(key, "thimble 1 session");
  derivation.add(arm);
  derivation.add(world);
  const std::uint64_t ordered = in_network_order(session);
  derivation.add(std::as_bytes(std::span(&ordered, 1)));
  Halves halves = derivation.finish();
  Seal seal(Kind::Session, half_of(halves, towards));
  sodium_memzero(halves.data(), halves.size());
  return seal;
}

std::size_t Seal::content_begin() const noexcept {
  return kThimbleHeaderSize + (kind_ == Kind::Handshake ? kHandshakeNonce : 0);
}

void Seal::close(const ThimbleHeader& header, std::size_t content_size, const RandomBytes& random,
                 ThimbleDatagram& out) const {
  const std::size_t begin = content_begin();
  out.size = begin + content_size + (has_key() ? kTag : 0);
  std::byte* const content = out.bytes.data() + begin;
  const unsigned char* const clear = raw(out.bytes.data());
  unsigned char* const tag = raw(content + content_size);
  if (kind_ == Kind::Session) {
    const SessionNonce nonce = nonce_of(header.sequence);
    crypto_aead_chacha20poly1305_ietf_encrypt_detached(
        raw(content), tag, nullptr, raw(content), content_size, clear, kThimbleHeaderSize, nullptr,
        raw(nonce.data()), raw(key_.data()));
  } else if (kind_ == Kind::Handshake) {
    const auto nonce = std::span(out.bytes).subspan<kThimbleHeaderSize, kHandshakeNonce>();
    random(nonce);
    crypto_aead_xchacha20poly1305_ietf_encrypt_detached(
        raw(content), tag, nullptr, raw(content), content_size, clear, kThimbleHeaderSize, nullptr,
        raw(nonce.data()), raw(key_.data()));
  }
}

Decoded<std::span<const std::byte>> Seal::open(
    const ThimbleHeader& header, std::span<const std::byte> datagram,
    std::span<std::byte, kMaxThimbleContent> room) const noexcept {
  if (header.is_sealed != has_key()) return tl::unexpected(RejectReason::BadSeal);
  const std::size_t begin = content_begin();
  const std::size_t around = begin + (has_key() ? kTag : 0);
  if (datagram.size() < around || datagram.size() - around > room.size()) {
    return tl::unexpected(RejectReason::WrongSize);
  }
  const std::size_t size = datagram.size() - around;
  const auto content = datagram.subspan(begin, size);
  if (!has_key()) return content;
  const unsigned char* const clear = raw(datagram.data());
  const unsigned char* const tag = raw(content.data() + size);
  int result = -1;
  if (kind_ == Kind::Session) {
    const SessionNonce nonce = nonce_of(header.sequence);
    result = crypto_aead_chacha20poly1305_ietf_decrypt_detached(
        raw(room.data()), nullptr, raw(content.data()), size, tag, clear, kThimbleHeaderSize,
        raw(nonce.data()), raw(key_.data()));
  } else {
    result = crypto_aead_xchacha20poly1305_ietf_decrypt_detached(
        raw(room.data()), nullptr, raw(content.data()), size, tag, clear, kThimbleHeaderSize,
        clear + kThimbleHeaderSize, raw(key_.data()));
  }
  if (result != 0) return tl::unexpected(RejectReason::BadSeal);
  return std::span<const std::byte>(room).first(size);
}

}  // namespace thimble::link
