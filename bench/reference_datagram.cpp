#include "bench/reference_datagram.hpp"

#include <sodium.h>

#include <cstring>
#include <vector>

unsigned reference_copies(std::size_t size, int times) {
  std::vector<unsigned char> here(size, 1);
  std::vector<unsigned char> there(size);
  unsigned sum = 0;
  for (int i = 0; i < times; ++i) {
    here[0] = static_cast<unsigned char>(i);
    std::memcpy(there.data(), here.data(), size);
    asm volatile("" : : "r"(there.data()) : "memory");
    std::memcpy(here.data(), there.data(), size);
    asm volatile("" : : "r"(here.data()) : "memory");
    sum += here[0];
  }
  return sum;
}

int reference_seals(std::size_t size, int times) {
  if (sodium_init() < 0) return 0;
  std::vector<unsigned char> clear(size, 1);
  std::vector<unsigned char> sealed(size + crypto_aead_chacha20poly1305_IETF_ABYTES);
  const std::vector<unsigned char> head(24, 2);
  const std::vector<unsigned char> key(crypto_aead_chacha20poly1305_IETF_KEYBYTES, 3);
  std::vector<unsigned char> nonce(crypto_aead_chacha20poly1305_IETF_NPUBBYTES);
  int opened = 0;
  for (int i = 0; i < times; ++i) {
    std::memcpy(nonce.data(), &i, sizeof i);
    crypto_aead_chacha20poly1305_ietf_encrypt(sealed.data(), nullptr, clear.data(), size,
                                              head.data(), head.size(), nullptr, nonce.data(),
                                              key.data());
    opened += crypto_aead_chacha20poly1305_ietf_decrypt(clear.data(), nullptr, nullptr,
                                                        sealed.data(), sealed.size(), head.data(),
                                                        head.size(), nonce.data(), key.data()) == 0
                  ? 1
                  : 0;
  }
  return opened;
}
