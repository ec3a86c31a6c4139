// hidapi at link level: see fake_hidapi.hpp. A program that lists this file among its sources never
// calls the real library.
#include "tests/support/fake_hidapi.hpp"

#include <hidapi.h>
#include <poll.h>

#include <algorithm>
#include <map>
#include <utility>

// hidapi's own name of a handle.
struct hid_device_ {
  thimble::test::FakeHidWire* wire{nullptr};
  std::deque<thimble::test::FakeHidWire::Report> waiting;
  int users{0};
};

namespace thimble::test {

struct FakeHidapi {
  static constexpr std::size_t kKernelReports = 64;  // HIDRAW_BUFFER_SIZE of linux/hidraw.h

  std::mutex lock;
  std::condition_variable changed;
  std::map<std::string, FakeHidWire*> nodes;
  int alive{0};

  static FakeHidapi& instance() {
    static FakeHidapi fake;
    return fake;
  }
  using Guard = std::unique_lock<std::mutex>;

  hid_device_* open(const std::string& path) {
    Guard guard(lock);
    const auto found = nodes.find(path);
    if (found == nodes.end() || found->second->is_gone_) return nullptr;
    FakeHidWire& wire = *found->second;
    if (const auto happening = std::exchange(wire.at_next_opening_, nullptr)) {
      guard.unlock();
      happening();
      guard.lock();
    }
    if (wire.openings_to_refuse_ > 0) {
      --wire.openings_to_refuse_;
      return nullptr;
    }
    auto* handle = new hid_device_{&wire, {}, 0};
    wire.handles_.push_back(handle);
    ++alive;
    return handle;
  }

  void close(hid_device_* handle) {
    const Guard guard(lock);
    if (handle->users > 0) handle->wire->breaches_.emplace_back("closed while in use");
    std::erase(handle->wire->handles_, handle);
    delete handle;
    --alive;
  }

  static void enter(hid_device_& handle) {
    if (++handle.users > 1) handle.wire->breaches_.emplace_back("a handle in two threads at once");
  }

  int read(hid_device_& handle, unsigned char* data, std::size_t length, int wait_ms) {
    Guard guard(lock);
    enter(handle);
    const auto is_ready = [&] { return !handle.waiting.empty() || handle.wire->is_gone_; };
    for (int slice = 0; slice < wait_ms && !is_ready(); ++slice) {
      guard.unlock();
      ::poll(nullptr, 0, 1);
      guard.lock();
    }
    --handle.users;
    if (handle.wire->is_gone_) return -1;
    if (handle.waiting.empty()) return 0;
    const FakeHidWire::Report report = std::move(handle.waiting.front());
    handle.waiting.pop_front();
    const std::size_t bytes = std::min(length, report.size());
    std::copy_n(report.begin(), bytes, data);
    return static_cast<int>(bytes);
  }

  int write(hid_device_& handle, const unsigned char* data, std::size_t length) {
    Guard guard(lock);
    enter(handle);
    FakeHidWire& wire = *handle.wire;
    if (length < 2) wire.breaches_.emplace_back("a write of less than a number and a byte");
    ++wire.blocked_writes_;
    while (wire.is_blocking_ && !wire.is_gone_) changed.wait(guard);
    --wire.blocked_writes_;
    --handle.users;
    if (wire.is_gone_) return -1;
    if (wire.writes_to_fail_ > 0) {
      --wire.writes_to_fail_;
      return -1;
    }
    if (wire.writes_to_cut_ > 0) {
      --wire.writes_to_cut_;
      return static_cast<int>(length) - 1;
    }
    wire.received_.emplace_back(data + (data[0] == 0 ? 1 : 0), data + length);
    return static_cast<int>(length);
  }

  void send(FakeHidWire& wire, const FakeHidWire::Report& report) {
    const Guard guard(lock);
    for (hid_device_* handle : wire.handles_) {
      if (handle->waiting.size() < kKernelReports) handle->waiting.push_back(report);
    }
    changed.notify_all();
  }

  void add(const std::string& path, FakeHidWire& wire) {
    const Guard guard(lock);
    nodes[path] = &wire;
  }

  void forget(FakeHidWire& wire) {
    const Guard guard(lock);
    std::erase_if(nodes, [&](const auto& node) { return node.second == &wire; });
  }

  template <class Change>
  auto with(const Change& change) {
    const Guard guard(lock);
    changed.notify_all();
    return change();
  }
};

namespace {
FakeHidapi& fake() { return FakeHidapi::instance(); }
}  // namespace

FakeHidWire::FakeHidWire() : node_(folder_.write("hidraw0", "").string()) { attach(node_); }
FakeHidWire::~FakeHidWire() { fake().forget(*this); }

void FakeHidWire::attach(const std::string& path) { fake().add(path, *this); }
void FakeHidWire::device_sends(const Report& report) { fake().send(*this, report); }
std::vector<FakeHidWire::Report> FakeHidWire::received_by_device() const {
  return fake().with([&] { return received_; });
}
void FakeHidWire::unplug() {
  fake().with([&] { is_gone_ = true; });
}
void FakeHidWire::block_writes() {
  fake().with([&] { is_blocking_ = true; });
}
void FakeHidWire::release_writes() {
  fake().with([&] { is_blocking_ = false; });
}
bool FakeHidWire::is_write_blocked() const {
  return fake().with([&] { return is_blocking_ && blocked_writes_ > 0; });
}
void FakeHidWire::fail_next_writes(int writes) {
  fake().with([&] { writes_to_fail_ = writes; });
}
void FakeHidWire::cut_next_writes(int writes) {
  fake().with([&] { writes_to_cut_ = writes; });
}
void FakeHidWire::refuse_next_opening(int openings) {
  fake().with([&] { openings_to_refuse_ = openings; });
}
void FakeHidWire::at_next_opening(std::function<void()> happening) {
  fake().with([&] { at_next_opening_ = std::move(happening); });
}
std::vector<std::string> FakeHidWire::breaches() const {
  return fake().with([&] { return breaches_; });
}
int FakeHidWire::alive() {
  return fake().with([] { return fake().alive; });
}

}  // namespace thimble::test

using thimble::test::FakeHidapi;

extern "C" {

hid_device* hid_open_path(const char* path) { return FakeHidapi::instance().open(path); }

void hid_close(hid_device* device) { FakeHidapi::instance().close(device); }

int hid_read_timeout(hid_device* device, unsigned char* data, size_t length, int milliseconds) {
  return FakeHidapi::instance().read(*device, data, length, milliseconds);
}

int hid_write(hid_device* device, const unsigned char* data, size_t length) {
  return FakeHidapi::instance().write(*device, data, length);
}

}  // extern "C"
