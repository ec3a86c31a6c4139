#include "daemon/link/seal.hpp"

#include <gtest/gtest.h>
#include <sodium.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "golden_datagrams.hpp"

namespace thimble::link {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr std::uint64_t kToken = 0x0102030405060708;

LinkKey key_of(unsigned seed) {
  std::array<std::byte, LinkKey::kSize> bytes{};
  bytes.fill(std::byte(seed));
  return LinkKey(bytes);
}

Nonce nonce_of(unsigned value) {
  Nonce nonce{};
  nonce.fill(std::byte(value));
  return nonce;
}

RandomBytes counted_random() {
  return [next = 0U](std::span<std::byte> out) mutable {
    for (std::byte& byte : out) byte = std::byte(next++ & 0xFFU);
  };
}

Seal session_seal(unsigned key = 1, Towards towards = Towards::World, unsigned arm = 2,
                  unsigned world = 3, std::uint64_t session = kToken) {
  return Seal::of_session(key_of(key), towards, nonce_of(arm), nonce_of(world), session);
}

ThimbleDatagram packed(const Seal& seal, std::uint64_t sequence = 7) {
  ThimbleDatagram out;
  const ThimbleIdle idle{.request = 42};
  EXPECT_TRUE(seal.pack({ThimbleKind::Idle, false, kToken, sequence}, idle, counted_random(), out)
                  .has_value());
  return out;
}

// What the other end reads, or why it does not.
Decoded<ThimbleIdle> opened(const Seal& seal, std::span<const std::byte> bytes) {
  const Decoded<ThimbleHeader> header = decode_header(bytes);
  if (!header) return tl::unexpected(header.error());
  std::array<std::byte, kMaxThimbleContent> room{};
  const auto content = seal.open(*header, bytes, room);
  if (!content) return tl::unexpected(content.error());
  ThimbleIdle out;
  const Decoded<void> done = decode(*content, out);
  if (!done) return tl::unexpected(done.error());
  return out;
}

TEST(SealTest, OpensWhatItSealed) {
  const std::array seals{Seal(), Seal::of_handshake(key_of(1), Towards::World), session_seal()};
  const std::array<std::size_t, 3> sizes{56, 56 + 24 + 16, 56 + 16};
  for (std::size_t i = 0; i < seals.size(); ++i) {
    const ThimbleDatagram datagram = packed(seals[i]);
    EXPECT_EQ(datagram.size, sizes[i]);
    const Decoded<ThimbleIdle> idle = opened(seals[i], datagram.view());
    ASSERT_TRUE(idle.has_value());
    EXPECT_EQ(idle->request, 42U);
  }
}

TEST(SealTest, RefusesEveryOtherKeyDirectionAndSession) {
  const ThimbleDatagram datagram = packed(session_seal());
  for (const Seal& other :
       {session_seal(9), session_seal(1, Towards::Arm), session_seal(1, Towards::World, 9),
        session_seal(1, Towards::World, 2, 9), session_seal(1, Towards::World, 2, 3, kToken + 1),
        Seal()}) {
    EXPECT_EQ(opened(other, datagram.view()).error(), RejectReason::BadSeal);
  }
  const ThimbleDatagram hello = packed(Seal::of_handshake(key_of(1), Towards::World));
  EXPECT_EQ(opened(Seal::of_handshake(key_of(2), Towards::World), hello.view()).error(),
            RejectReason::BadSeal);
  EXPECT_EQ(opened(Seal::of_handshake(key_of(1), Towards::Arm), hello.view()).error(),
            RejectReason::BadSeal);
  EXPECT_EQ(opened(session_seal(), packed(Seal()).view()).error(), RejectReason::BadSeal);
}

TEST(SealTest, RefusesADatagramInWhichAnyBitWasTurned) {
  for (const Seal& seal : {session_seal(), Seal::of_handshake(key_of(1), Towards::Arm)}) {
    const ThimbleDatagram datagram = packed(seal);
    for (std::size_t bit = 0; bit < 8 * datagram.size; ++bit) {
      ThimbleDatagram changed = datagram;
      changed.bytes[bit / 8] ^= std::byte(1U << (bit % 8));
      EXPECT_FALSE(opened(seal, changed.view()).has_value()) << bit;
    }
  }
}

TEST(SealTest, RefusesEveryLengthButItsOwn) {
  const Seal seal = session_seal();
  ThimbleDatagram datagram = packed(seal);
  const std::size_t size = datagram.size;
  std::fill(datagram.bytes.begin() + static_cast<long>(size), datagram.bytes.end(), std::byte{0});
  for (datagram.size = 0; datagram.size <= kMaxThimbleDatagram; ++datagram.size) {
    EXPECT_EQ(opened(seal, datagram.view()).has_value(), datagram.size == size);
  }
}

TEST(SealTest, HidesTheContentAndNotTheHeader) {
  const ThimbleDatagram clear = packed(Seal());
  for (const Seal& seal : {session_seal(), Seal::of_handshake(key_of(1), Towards::World)}) {
    const ThimbleDatagram sealed = packed(seal);
    EXPECT_TRUE(std::equal(clear.bytes.begin(), clear.bytes.begin() + 6, sealed.bytes.begin()));
    const auto content = clear.view().subspan(kThimbleHeaderSize, 16);
    EXPECT_EQ(
        std::search(sealed.view().begin(), sealed.view().end(), content.begin(), content.end()),
        sealed.view().end());
  }
}

Bytes half_of_keys(std::string_view purpose, const Bytes& more, bool is_towards_world) {
  Bytes in(purpose.begin(), purpose.end());
  in.insert(in.end(), more.begin(), more.end());
  const Bytes key(32, 1);
  Bytes out(64);
  crypto_generichash(out.data(), out.size(), in.data(), in.size(), key.data(), key.size());
  return {out.begin() + (is_towards_world ? 0 : 32), out.begin() + (is_towards_world ? 32 : 64)};
}

// As the page has it, with libsodium's calls for whole messages and none of the product's.
TEST(SealTest, IsWhatThePageSays) {
  Bytes more(32, 2);
  more.insert(more.end(), 32, 3);
  for (unsigned char i = 1; i <= 8; ++i) more.push_back(i);
  const ThimbleDatagram datagram = packed(session_seal(1, Towards::Arm), 0x0A0B);
  const auto* bytes = reinterpret_cast<const unsigned char*>(datagram.bytes.data());
  Bytes clear(32);
  const Bytes nonce{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x0A, 0x0B};
  ASSERT_EQ(crypto_aead_chacha20poly1305_ietf_decrypt(
                clear.data(), nullptr, nullptr, bytes + 24, datagram.size - 24, bytes, 24,
                nonce.data(), half_of_keys("thimble 1 session", more, false).data()),
            0);
  EXPECT_EQ(clear[31], 42);

  const ThimbleDatagram hello = packed(Seal::of_handshake(key_of(1), Towards::World));
  bytes = reinterpret_cast<const unsigned char*>(hello.bytes.data());
  ASSERT_EQ(crypto_aead_xchacha20poly1305_ietf_decrypt(
                clear.data(), nullptr, nullptr, bytes + 48, hello.size - 48, bytes, 24, bytes + 24,
                half_of_keys("thimble 1 handshake", {}, true).data()),
            0);
  EXPECT_EQ(clear[31], 42);
}

// Both ways: what is packed are those bytes, and they open to the clear datagram's content.
template <class Message>
void expect_golden(const std::string& name, const Seal& seal, std::span<const std::byte> sealed) {
  SCOPED_TRACE(name);
  const auto clear = std::span(testing::golden().at(name));
  const auto content = clear.subspan(kThimbleHeaderSize);
  Message message;
  ASSERT_TRUE(decode(content, message).has_value());
  const RandomBytes random = [](std::span<std::byte> out) {
    const Nonce counted = testing::counted_from(160);
    std::copy_n(counted.begin(), out.size(), out.begin());
  };
  ThimbleDatagram out;
  ASSERT_TRUE(seal.pack(decode_header(clear).value(), message, random, out).has_value());
  EXPECT_TRUE(std::ranges::equal(out.view(), sealed));
  std::array<std::byte, kMaxThimbleContent> room{};
  const auto opened = seal.open(decode_header(sealed).value(), sealed, room);
  ASSERT_TRUE(opened.has_value());
  EXPECT_TRUE(std::ranges::equal(*opened, content));
}

// Written without libsodium: a seal that changed at both ends would open, and talk to no other.
TEST(SealTest, GoldenBytesAreWrittenAndOpened) {
  const auto sealed = testing::datagrams_in("thimble_sealed_datagrams.txt");
  ASSERT_EQ(sealed.size(), 3U);
  const LinkKey key(testing::counted_from(128));
  const auto of_session = [&key](Towards towards) {
    return Seal::of_session(key, towards, testing::counted_from(0), testing::counted_from(64),
                            0x0123456789ABCDEF);
  };
  expect_golden<ThimbleHello>("hello", Seal::of_handshake(key, Towards::World), sealed.at("hello"));
  expect_golden<ThimbleSample>("sample_least", of_session(Towards::World),
                               sealed.at("sample_least"));
  expect_golden<ThimbleIdle>("idle", of_session(Towards::Arm), sealed.at("idle"));
}

TEST(SealTest, TheLargestMessageFitsWithItsSeal) {
  ThimbleConstraints most;
  while (most.set.planes.push_back({{0, 1, 0}, 0.1, {{1}, {1}, 1, 300}})) {
  }
  most.set.has_ghost = most.set.has_far = most.set.has_map = true;
  most.set.map.lattice = {.cells = {64, 64, 64}, .half_cell_m = 0.001};
  while (most.set.map.blocks.push_back({})) {
  }
  ThimbleDatagram out;
  ASSERT_TRUE(session_seal()
                  .pack({ThimbleKind::Constraints, false, kToken, 1}, most, counted_random(), out)
                  .has_value());
  EXPECT_LE(out.size, kMaxThimbleDatagram);
}

TEST(SealTest, DrawsFromTheSystemWhatIsNotTheSameTwice) {
  const RandomBytes random = system_random();
  Nonce first{};
  Nonce second{};
  random(first);
  random(second);
  EXPECT_NE(first, second);
}

}  // namespace
}  // namespace thimble::link
