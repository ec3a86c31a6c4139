#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/link/endpoint.hpp"

namespace thimble::lab {

// A configuration, and what it is called among those that are played together.
struct PlayedFile {
  std::string name;    // of the file, without its folder and its end
  std::string text{};  // what was read of it
  config::Config config{};
};

// By what address each is known to the others, whatever its port: by the one that they pin for it,
// else by the one that they link to, else 127.0.0.1. Pure.
[[nodiscard]] std::vector<link::Endpoint> host_addresses(const std::vector<PlayedFile>& files);

// Whether one of `files` listens at the port that an arm links to. Pure.
[[nodiscard]] bool is_heard(const config::UdpEndpoint& link, const std::vector<PlayedFile>& files);
// Whether one of `files` but number `file` listens at the device of a line that an arm of that one
// links to: here those of the same name are joined. Pure.
[[nodiscard]] bool is_heard(const config::SerialEndpoint& link, std::size_t file,
                            const std::vector<PlayedFile>& files);
// Of all `files` at a device of that name: more than two are too many. Pure.
[[nodiscard]] std::size_t ends_at(const std::string& node, const std::vector<PlayedFile>& files);

}  // namespace thimble::lab
