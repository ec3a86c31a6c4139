#pragma once

#include <cstddef>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "daemon/link/thimble_codec.hpp"

namespace thimble::link::testing {

inline Nonce counted_from(unsigned first) {
  Nonce nonce{};
  for (std::size_t i = 0; i < nonce.size(); ++i) nonce[i] = std::byte(first + i);
  return nonce;
}

using NamedDatagrams = std::map<std::string, std::vector<std::byte>>;

// A file of tests/data that thimble_datagrams.py wrote: each line a name and bytes in hexadecimal.
inline NamedDatagrams datagrams_in(const std::string& file_name) {
  NamedDatagrams out;
  std::ifstream file(THIMBLE_SOURCE_DIR "/tests/data/" + file_name);
  for (std::string name, hex; file >> name >> hex;) {
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
      out[name].push_back(std::byte(std::stoi(hex.substr(i, 2), nullptr, 16)));
    }
  }
  return out;
}

inline const NamedDatagrams& golden() {
  static const NamedDatagrams read = datagrams_in("thimble_datagrams.txt");
  return read;
}

}  // namespace thimble::link::testing
