#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::sim {

class EventQueue;

// Something that happens at a point of virtual time; whoever derives from it owns it and
// may schedule it again and again without an allocation.
//
// Thread: the one that runs the clock. RT: fire() must be THIMBLE_RT when a servo thread runs
// the clock. Ownership: the queue only points at it; the destructor takes it off the queue.
class Event {
 public:
  Event() = default;
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  virtual ~Event();
  // Called once per schedule(), when the event is already off the queue: it may schedule
  // itself again (for later than `now`), schedule or cancel others, or destroy itself.
  virtual void fire(MonotonicTime now) noexcept = 0;
  [[nodiscard]] bool is_scheduled() const noexcept { return queue_ != nullptr; }

 private:
  friend class EventQueue;
  EventQueue* queue_{nullptr};
  std::size_t position_{0};  // in the queue's heap
  MonotonicTime due_{};
  std::uint64_t sequence_{0};
};

// Pending events in the order (time, order of scheduling).
//
// Thread: the one that runs the clock; before that, the one that sets up.
// RT: all THIMBLE_RT while at most `capacity()` events are pending: O(log n), no allocation.
class EventQueue {
 public:
  explicit EventQueue(std::size_t reserved_events = 256) { heap_.reserve(reserved_events); }
  EventQueue(const EventQueue&) = delete;
  EventQueue& operator=(const EventQueue&) = delete;
  ~EventQueue();

  // An event that is scheduled already is moved, as if it had been cancelled first.
  // A time in the past is due at once, after what is due before it.
  THIMBLE_RT void schedule_at(Event& event, MonotonicTime due);
  // Returns false when the event was not on this queue.
  THIMBLE_RT bool cancel(Event& event) noexcept;
  // Takes the first event that is due at or before `limit`; nullptr when there is none.
  THIMBLE_RT Event* take_due(MonotonicTime limit, MonotonicTime& due) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return heap_.size(); }
  [[nodiscard]] std::size_t capacity() const noexcept { return heap_.capacity(); }

 private:
  [[nodiscard]] static bool is_before(const Event& a, const Event& b) noexcept;
  void place(Event* event, std::size_t position) noexcept;
  void sift_up(std::size_t position) noexcept;
  void sift_down(std::size_t position) noexcept;
  void remove(std::size_t position) noexcept;

  std::vector<Event*> heap_;  // binary heap, first event at the front
  std::uint64_t next_sequence_{0};
};

}  // namespace thimble::sim
