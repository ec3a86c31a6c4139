#include "sim/time/event_queue.hpp"

namespace thimble::sim {

Event::~Event() {
  if (queue_ != nullptr) queue_->cancel(*this);
}

EventQueue::~EventQueue() {
  for (Event* event : heap_) event->queue_ = nullptr;
}

void EventQueue::schedule_at(Event& event, MonotonicTime due) {
  if (event.queue_ != nullptr) event.queue_->cancel(event);
  event.due_ = due;
  event.sequence_ = next_sequence_++;
  heap_.push_back(&event);
  event.queue_ = this;
  event.position_ = heap_.size() - 1;
  sift_up(event.position_);
}

bool EventQueue::cancel(Event& event) noexcept {
  if (event.queue_ != this) return false;
  remove(event.position_);
  return true;
}

Event* EventQueue::take_due(MonotonicTime limit, MonotonicTime& due) noexcept {
  if (heap_.empty() || heap_.front()->due_ > limit) return nullptr;
  Event* event = heap_.front();
  due = event->due_;
  remove(0);
  return event;
}

bool EventQueue::is_before(const Event& a, const Event& b) noexcept {
  if (a.due_ != b.due_) return a.due_ < b.due_;
  return a.sequence_ < b.sequence_;
}

void EventQueue::place(Event* event, std::size_t position) noexcept {
  heap_[position] = event;
  event->position_ = position;
}

void EventQueue::sift_up(std::size_t position) noexcept {
  Event* event = heap_[position];
  while (position > 0) {
    const std::size_t parent = (position - 1) / 2;
    if (!is_before(*event, *heap_[parent])) break;
    place(heap_[parent], position);
    position = parent;
  }
  place(event, position);
}

void EventQueue::sift_down(std::size_t position) noexcept {
  Event* event = heap_[position];
  for (;;) {
    std::size_t child = 2 * position + 1;
    if (child >= heap_.size()) break;
    if (child + 1 < heap_.size() && is_before(*heap_[child + 1], *heap_[child])) ++child;
    if (!is_before(*heap_[child], *event)) break;
    place(heap_[child], position);
    position = child;
  }
  place(event, position);
}

void EventQueue::remove(std::size_t position) noexcept {
  heap_[position]->queue_ = nullptr;
  Event* last = heap_.back();
  heap_.pop_back();
  if (position == heap_.size()) return;
  place(last, position);
  sift_up(position);
  sift_down(last->position_);
}

}  // namespace thimble::sim
