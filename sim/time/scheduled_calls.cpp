#include "sim/time/scheduled_calls.hpp"

#include <utility>

namespace thimble::sim {

class ScheduledCalls::Call final : public Event {
 public:
  Call(ScheduledCalls& owner, CallId id, std::function<void(MonotonicTime)> function) noexcept
      : owner_(&owner), id_(id), function_(std::move(function)) {}

  void fire(MonotonicTime now) noexcept override {
    const std::function<void(MonotonicTime)> function = std::move(function_);
    owner_->pending_.erase(id_);  // destroys *this
    function(now);
  }

 private:
  ScheduledCalls* owner_;
  CallId id_;
  std::function<void(MonotonicTime)> function_;
};

ScheduledCalls::ScheduledCalls(EventQueue& events) noexcept : events_(&events) {}
ScheduledCalls::~ScheduledCalls() = default;

ScheduledCalls::CallId ScheduledCalls::schedule_at(MonotonicTime due,
                                                   std::function<void(MonotonicTime)> function) {
  const CallId id = next_id_++;
  auto call = std::make_unique<Call>(*this, id, std::move(function));
  events_->schedule_at(*call, due);
  pending_.emplace(id, std::move(call));
  return id;
}

bool ScheduledCalls::cancel(CallId id) noexcept { return pending_.erase(id) != 0; }

}  // namespace thimble::sim
