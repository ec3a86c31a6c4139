#include "lab/trial/datagram_link.hpp"

#include <utility>

#include "daemon/link/earliest.hpp"
#include "lab/trial/random.hpp"

namespace thimble::lab {
namespace {

link::RandomBytes random_bytes(std::uint64_t seed) {
  return [random = Random(seed)](std::span<std::byte> out) mutable {
    for (std::byte& byte : out) byte = std::byte(random.next() & 0xFFU);
  };
}

}  // namespace

DatagramLink::DatagramLink(const Settings& settings, link::ThimbleWorldEnd::MakeHalf make_half)
    : random_(random_bytes(settings.seed)),
      world_(settings.world, std::move(make_half), random_bytes(~settings.seed)) {
  place_.address = {127, 0, 0, 1};
  place_.port = 40'000;
  restart_arm(settings.arm);
}

void DatagramLink::restart_arm(const link::ThimbleArmEnd::Settings& settings) {
  ++place_.port;
  arm_ = std::make_unique<link::ThimbleArmEnd>(settings, random_);
}

std::optional<MonotonicTime> DatagramLink::pump(MonotonicTime now) {
  if (coupling::HandSample sample; mailbox_.take(sample)) arm_->offer(sample);
  while (carry(now)) {
  }
  mailbox_.publish(arm_->quality());
  std::optional<MonotonicTime> due = arm_->next_due();
  link::take_earlier(due, world_.next_due());
  return due;
}

// False when nothing moved.
bool DatagramLink::carry(MonotonicTime now) {
  bool has_moved = false;
  for (coupling::ConstraintSet reply; arm_->take_reply(now, reply);) mailbox_.deliver(reply);
  for (link::ThimbleDatagram datagram; arm_->poll(now, datagram); has_moved = true) {
    if (on_sent) on_sent(datagram);
    world_.on_datagram(place_, datagram.view(), now);
  }
  for (link::ThimbleWorldEnd::Reply reply; world_.poll(now, reply); has_moved = true) {
    if (reply.to == place_) arm_->on_datagram(reply.datagram.view(), now);
  }
  return has_moved;
}

void DatagramLink::send_to_world(std::span<const std::byte> bytes, MonotonicTime now) {
  link::Endpoint elsewhere = place_;
  elsewhere.port = 1;
  world_.on_datagram(elsewhere, bytes, now);
}

}  // namespace thimble::lab
