#include "lab/run/virtual_lines.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "daemon/link/earliest.hpp"
#include "lab/run/uart.hpp"

namespace thimble::lab {

using link::LinePort;

class VirtualLines::Host final : public link::LinePorts {
 public:
  explicit Host(VirtualLines& lines) : lines_(&lines) {}
  [[nodiscard]] std::unique_ptr<LinePort> make_port(const std::string& node,
                                                    std::uint32_t bit_per_s) override;
  [[nodiscard]] VirtualLines& lines() const noexcept { return *lines_; }

 private:
  VirtualLines* lines_;
};

class VirtualLines::Port final : public LinePort {
 public:
  Port(const Host& host, std::string node, std::uint32_t bit_per_s)
      : host_(&host), node_(std::move(node)), bit_per_s_(bit_per_s), sender_(bit_per_s) {
    lines().ports_.push_back(this);
  }
  ~Port() override { std::erase(lines().ports_, this); }

  void start(Handlers handlers) override {
    handlers_ = std::move(handlers);
    open();
  }
  [[nodiscard]] bool has_room() const noexcept override {
    return receiver_.has_value() && !is_writing_;
  }
  void send(const link::SerialFrame& frame) override {
    leaving_ = frame;
    taken_ = 0;
    is_writing_ = true;
    write_at_ = now();
    write();
  }
  void wake_after(MonotonicTime now, Duration wait) override {
    link::take_earlier(wakes_at_, now + wait);
  }
  [[nodiscard]] const std::string& last_error() const noexcept override { return last_error_; }

  [[nodiscard]] bool is_open() const noexcept { return receiver_.has_value(); }
  [[nodiscard]] bool is_joined_to(const Port& other) const {
    return is_open() && other.is_open() && host_ != other.host_ && node_ == other.node_;
  }
  void pass();
  void hear(Port& far_end);
  void lose();
  [[nodiscard]] std::optional<MonotonicTime> due(const Port* far_end) const;

 private:
  [[nodiscard]] VirtualLines& lines() const noexcept { return host_->lines(); }
  [[nodiscard]] MonotonicTime now() const noexcept { return lines().clock_->now(); }
  void open();
  void write();

  const Host* host_;
  std::string node_;
  std::uint32_t bit_per_s_;
  UartSender sender_;
  std::optional<UartReceiver> receiver_;  // none: closed
  Handlers handlers_{};
  std::optional<MonotonicTime> opens_at_;
  std::optional<MonotonicTime> wakes_at_;
  link::SerialFrame leaving_{};
  std::size_t taken_{0};  // of it, by the kernel
  bool is_writing_{false};
  MonotonicTime write_at_{};  // next, while it is
  std::string last_error_;
};

void VirtualLines::Port::open() {
  for (const Port* other : lines().ports_) {
    if (!other->is_open() || other->host_ != host_ || other->node_ != node_) continue;
    last_error_ = node_ + " is held by another daemon";
    opens_at_ = now() + kOpenAgain;
    return;
  }
  receiver_.emplace(bit_per_s_, now());
  last_error_.clear();
  handlers_.on_timer();
}

// Its end is told in the next pass, as the system does.
void VirtualLines::Port::write() {
  const std::size_t room = kKernelTakes - std::min(kKernelTakes, sender_.held(now()));
  const auto rest = leaving_.view().subspan(taken_);
  const auto taken = rest.first(std::min(room, rest.size()));
  sender_.put(taken, now());
  taken_ += taken.size();
  if (taken_ < leaving_.size) write_at_ = sender_.comes_down_to(kKernelWakes);
}

void VirtualLines::Port::pass() {
  if (opens_at_ && *opens_at_ <= now()) {
    opens_at_.reset();
    open();
  }
  if (is_writing_ && write_at_ <= now()) {
    if (taken_ < leaving_.size) write();
    is_writing_ = taken_ < leaving_.size;
    if (!is_writing_) handlers_.on_timer();
  }
  if (wakes_at_ && *wakes_at_ <= now()) {
    wakes_at_.reset();
    handlers_.on_timer();
  }
}

void VirtualLines::Port::hear(Port& far_end) {
  const std::vector<std::byte> heard = receiver_->hear(far_end.sender_, now());
  far_end.sender_.forget_before(receiver_->heard_until(far_end.sender_));
  if (!heard.empty()) handlers_.on_bytes(heard);
}

// Nobody is at the other end.
void VirtualLines::Port::lose() { sender_.forget_before(sender_.clock().bit_at(now())); }

std::optional<MonotonicTime> VirtualLines::Port::due(const Port* far_end) const {
  std::optional<MonotonicTime> due = wakes_at_;
  link::take_earlier(due, opens_at_);
  if (is_writing_) link::take_earlier(due, write_at_);
  if (far_end != nullptr) link::take_earlier(due, receiver_->due(far_end->sender_));
  return due;
}

std::unique_ptr<LinePort> VirtualLines::Host::make_port(const std::string& node,
                                                        std::uint32_t bit_per_s) {
  return std::make_unique<Port>(*this, node, bit_per_s);
}

VirtualLines::VirtualLines(const Clock& clock, std::size_t hosts) : clock_(&clock) {
  for (std::size_t i = 0; i < hosts; ++i) hosts_.push_back(std::make_unique<Host>(*this));
}

VirtualLines::~VirtualLines() = default;

link::LinePorts& VirtualLines::host(std::size_t i) noexcept { return *hosts_[i]; }

VirtualLines::Port* VirtualLines::far_end_of(const Port& port) const {
  const auto found = std::find_if(ports_.begin(), ports_.end(),
                                  [&](const Port* other) { return port.is_joined_to(*other); });
  return found == ports_.end() ? nullptr : *found;
}

void VirtualLines::pass() {
  const std::vector<Port*> ports = ports_;
  for (Port* port : ports) port->pass();
  for (Port* port : ports) {
    Port* const far_end = far_end_of(*port);
    if (far_end != nullptr) port->hear(*far_end);
    if (far_end == nullptr) port->lose();
  }
}

std::optional<MonotonicTime> VirtualLines::due() const {
  std::optional<MonotonicTime> earliest;
  for (const Port* port : ports_) link::take_earlier(earliest, port->due(far_end_of(*port)));
  return earliest;
}

}  // namespace thimble::lab
