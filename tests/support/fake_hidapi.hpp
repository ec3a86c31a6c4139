#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"

struct hid_device_;

namespace thimble::test {

// What a hidraw node leads to when a test links fake_hidapi.cpp: the functions of hidapi that
// hal/linux uses, and behind them not a kernel but what the test says. As the kernel does, it keeps
// 64 reports for each handle and loses the newest beyond them, and reads the first byte of a write
// as the report's number. Every breach of hidapi's rules is written down: a handle in two threads
// at once, used when closed, written to without a number.
//
// Thread: any.
class FakeHidWire {
 public:
  using Report = std::vector<std::uint8_t>;

  // Makes a file `node()`; other paths are only opened by who knows them: attach().
  FakeHidWire();
  ~FakeHidWire();
  FakeHidWire(const FakeHidWire&) = delete;
  FakeHidWire& operator=(const FakeHidWire&) = delete;

  [[nodiscard]] const std::string& node() const noexcept { return node_; }
  // This path leads here, too.
  void attach(const std::string& path);

  // The device sends it now.
  void device_sends(const Report& report);
  // Without the number 0 of reports that have none.
  [[nodiscard]] std::vector<Report> received_by_device() const;
  void unplug();
  // From now on a write takes until release_writes(), as of a device that takes nothing.
  void block_writes();
  void release_writes();
  [[nodiscard]] bool is_write_blocked() const;
  // The next writes fail, or take one byte less than they should.
  void fail_next_writes(int writes);
  void cut_next_writes(int writes);
  void refuse_next_opening(int openings);
  // Happens once, when somebody opens a node that leads here, and in their thread.
  void at_next_opening(std::function<void()> happening);

  [[nodiscard]] std::vector<std::string> breaches() const;
  // Handles that exist, of all wires.
  [[nodiscard]] static int alive();

 private:
  friend struct FakeHidapi;

  thimble::testing_support::TemporaryFolder folder_;
  std::string node_;
  std::vector<hid_device_*> handles_;
  std::vector<Report> received_;
  std::vector<std::string> breaches_;
  int writes_to_fail_{0};
  int writes_to_cut_{0};
  int openings_to_refuse_{0};
  std::function<void()> at_next_opening_;
  int blocked_writes_{0};
  bool is_blocking_{false};
  bool is_gone_{false};
};

}  // namespace thimble::test
