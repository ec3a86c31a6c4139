#include "bench/reference_ping_pong.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <thread>

namespace {

constexpr std::size_t kPing = 12;
constexpr std::size_t kPong = 13;

// Bound to a free port of loopback, which `address` then holds.
int make_socket(sockaddr_in& address) {
  address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int fd = ::socket(AF_INET, SOCK_DGRAM, 0);
  socklen_t size = sizeof address;
  if (::bind(fd, reinterpret_cast<sockaddr*>(&address), size) != 0) return -1;
  ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  return fd;
}

void send_to(int fd, const char* bytes, std::size_t size, const sockaddr_in& to) {
  ::sendto(fd, bytes, size, 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

// Answers until a datagram of another size comes.
void answer(int fd) {
  char bytes[64];
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t received =
        ::recvfrom(fd, bytes, sizeof bytes, 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (received != static_cast<ssize_t>(kPing)) return;
    send_to(fd, bytes, kPong, from);
  }
}

}  // namespace

std::vector<double> reference_ping_pong(std::size_t round_trips) {
  sockaddr_in server_address;
  sockaddr_in client_address;
  const int server = make_socket(server_address);
  const int client = make_socket(client_address);
  if (server < 0 || client < 0) return {};
  std::thread thread([server] { answer(server); });
  std::vector<double> trips_s;
  char bytes[64] = {};
  for (std::size_t i = 0; i < round_trips; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    send_to(client, bytes, kPing, server_address);
    ::recvfrom(client, bytes, sizeof bytes, 0, nullptr, nullptr);
    const auto end = std::chrono::steady_clock::now();
    trips_s.push_back(std::chrono::duration<double>(end - begin).count());
  }
  send_to(client, bytes, 1, server_address);
  thread.join();
  ::close(server);
  ::close(client);
  return trips_s;
}
