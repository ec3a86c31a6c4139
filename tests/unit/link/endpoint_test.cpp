#include "daemon/link/endpoint.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace thimble::link {
namespace {

TEST(Endpoint, ReadsNumericAddressesAndLocalhost) {
  const auto v4 = parse_endpoint("udp://192.168.7.20:5001");
  ASSERT_TRUE(v4.has_value());
  EXPECT_FALSE(v4->is_v6);
  EXPECT_EQ(v4->address[0], 192);
  EXPECT_EQ(v4->address[3], 20);
  EXPECT_EQ(v4->port, 5001);
  const auto v6 = parse_endpoint("udp://[2001:db8::1]:65535");
  ASSERT_TRUE(v6.has_value());
  EXPECT_TRUE(v6->is_v6);
  EXPECT_EQ(v6->address[0], 0x20);
  EXPECT_EQ(v6->address[15], 1);
  EXPECT_EQ(v6->port, 65535);
  EXPECT_EQ(*parse_endpoint("udp://localhost:0"), *parse_endpoint("udp://127.0.0.1:0"));
}

TEST(Endpoint, IsWrittenAsItIsRead) {
  for (const std::string text :
       {"udp://127.0.0.1:5001", "udp://[::1]:1", "udp://0.0.0.0:0", "udp://[2001:db8::1]:65535"}) {
    EXPECT_EQ(to_string(*parse_endpoint(text)), text);
  }
}

TEST(Endpoint, RefusesEverythingElseInOneSentence) {
  for (const std::string text : {"",
                                 "udp://",
                                 "udp://:",
                                 "127.0.0.1:5001",
                                 "tcp://127.0.0.1:5001",
                                 "udp://127.0.0.1",
                                 "udp://127.0.0.1:",
                                 "udp://127.0.0.1:65536",
                                 "udp://127.0.0.1:-1",
                                 "udp://127.0.0.1:+1",
                                 "udp://127.0.0.1:5001 ",
                                 "udp://127.0.0.1:0x10",
                                 "udp://1.2.3:1",
                                 "udp://1.2.3.4.5:1",
                                 "udp://256.1.1.1:1",
                                 "udp://::1:5001",
                                 "udp://[::1:5001",
                                 "udp://[]:1",
                                 "udp://[1.2.3.4]:1",
                                 "udp://[fe80::1%eth0]:1",
                                 "udp://example.org:1",
                                 "UDP://127.0.0.1:1",
                                 "udp://[localhost]:1",
                                 "udp://127.0.0.1:99999999999999999999"}) {
    const auto parsed = parse_endpoint(text);
    ASSERT_FALSE(parsed.has_value()) << text;
    EXPECT_EQ(parsed.error().code, Errc::InvalidArgument);
    EXPECT_NE(parsed.error().message.find("expected udp://ADDRESS:PORT"), std::string::npos);
  }
  EXPECT_FALSE(parse_endpoint(std::string("udp://127.0.0.1\0:5001", 21)).has_value());
  EXPECT_LT(parse_endpoint(std::string(100000, 'x')).error().message.size(), 300U);
}

TEST(Endpoint, ParsingIsTotal) {
  std::mt19937 random(6);
  const std::string alphabet = "udp://[]:.0123456789abcf%-+ \n";
  for (int i = 0; i < 20000; ++i) {
    std::string text = random() % 2 == 0 ? "udp://" : "";
    for (std::size_t length = random() % 24; length > 0; --length) {
      text += alphabet[random() % alphabet.size()];
    }
    const auto parsed = parse_endpoint(text);
    if (parsed) {
      EXPECT_EQ(*parse_endpoint(to_string(*parsed)), *parsed) << text;
    }
  }
}

TEST(Endpoint, KnowsLoopback) {
  for (const char* text :
       {"udp://127.0.0.1:1", "udp://127.8.8.8:1", "udp://[::1]:1", "udp://[::ffff:127.0.0.1]:1"}) {
    EXPECT_TRUE(parse_endpoint(text)->is_loopback()) << text;
  }
  for (const char* text : {"udp://0.0.0.0:1", "udp://10.0.0.1:1", "udp://[::]:1", "udp://[::2]:1",
                           "udp://[::ffff:10.0.0.1]:1", "udp://[1::1]:1"}) {
    EXPECT_FALSE(parse_endpoint(text)->is_loopback()) << text;
  }
}

// A socket of both families gives IPv4 senders as ::ffff:a.b.c.d (RFC 4291, 2.5.5.2).
TEST(Endpoint, AnIpv4AddressIsTheSameInEitherForm) {
  const auto at = [](const char* text) { return *parse_endpoint(text); };
  const Endpoint plain = at("udp://10.0.0.2:1");
  const Endpoint mapped = at("udp://[::ffff:10.0.0.2]:2");
  EXPECT_TRUE(plain.has_same_address(mapped));
  EXPECT_TRUE(mapped.has_same_address(plain));
  EXPECT_TRUE(mapped.has_same_address(mapped));
  for (const char* other : {"udp://10.0.0.3:1", "udp://[::ffff:10.0.0.3]:1", "udp://[::10.0.0.2]:1",
                            "udp://[a00:2::]:1", "udp://[1::ffff:10.0.0.2]:1"}) {
    EXPECT_FALSE(plain.has_same_address(at(other))) << other;
    EXPECT_FALSE(at(other).has_same_address(mapped)) << other;
  }
}

TEST(MayListen, BeyondLoopbackNeedsPermissionAndAPinnedPeer) {
  const Endpoint loopback = *parse_endpoint("udp://127.0.0.1:5001");
  const Endpoint any = *parse_endpoint("udp://0.0.0.0:5001");
  const Endpoint peer = *parse_endpoint("udp://10.0.0.7:0");
  EXPECT_TRUE(may_listen(loopback, false, std::nullopt).has_value());
  EXPECT_TRUE(may_listen(any, true, peer).has_value());
  for (const auto& refused : {may_listen(any, false, std::nullopt), may_listen(any, false, peer),
                              may_listen(any, true, std::nullopt)}) {
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().code, Errc::Permission);
    EXPECT_NE(refused.error().message.find("allow_unauthenticated = true"), std::string::npos);
  }
}

TEST(MayLink, BeyondLoopbackNeedsPermission) {
  const Endpoint loopback = *parse_endpoint("udp://127.0.0.1:5001");
  const Endpoint far = *parse_endpoint("udp://10.0.0.7:5001");
  EXPECT_TRUE(may_link(loopback, false).has_value());
  EXPECT_TRUE(may_link(far, true).has_value());
  const auto refused = may_link(far, false);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, Errc::Permission);
  EXPECT_NE(refused.error().message.find("udp://10.0.0.7:5001"), std::string::npos);
  EXPECT_NE(refused.error().message.find("allow_unauthenticated = true"), std::string::npos);
}

}  // namespace
}  // namespace thimble::link
