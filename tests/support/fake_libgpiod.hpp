#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

struct gpiod_line;

namespace thimble::test {

// What a node of a GPIO chip leads to when a test links fake_libgpiod.cpp: the functions of
// libgpiod 1.6 that hal/linux uses, and behind them not a kernel but what the test says. As the
// kernel (6.1) does, it keeps 16 events of each line and loses the newest beyond them, tells
// nothing to who waits on a chip that is pulled out, nor to who sets a line that the chip took
// nothing, and holds a line for one request.
//
// Thread: any.
class FakeGpioChip {
 public:
  // Makes the file `node`.
  FakeGpioChip(std::string node, std::string label, std::vector<std::string> names);
  ~FakeGpioChip();
  FakeGpioChip(const FakeGpioChip&) = delete;
  FakeGpioChip& operator=(const FakeGpioChip&) = delete;

  void set_wire(std::size_t line, bool is_high);
  [[nodiscard]] bool wire(std::size_t line) const;
  void lose_next_edges(int edges);
  // Pulled out; what was opened stays dead. And back.
  void unplug();
  void replug();
  // The request of one line ends: who waits for its edges is told.
  void end_request(std::size_t line);
  // Every transfer fails; of a level that is set nobody is told so.
  void fail_transfers(bool is_failing);
  // The same of all that concerns this line.
  void fail_line(std::size_t line, bool is_failing);
  // A level that is set is taken; who asks for one has no answer.
  void fail_questions(bool is_failing);
  // Called before each answer to who asks for a level, with the line.
  void before_answers(std::function<void(std::size_t line)> what);
  // Nobody may open it, or anybody again.
  void forbid(bool is_forbidden);
  // Somebody else has that line; an empty name: the kernel.
  void take(std::size_t line, std::string consumer);
  // Whether somebody asked for the edges of a line.
  [[nodiscard]] bool is_told_of_edges(std::size_t line) const;
  // Flags of the newest request of a line.
  [[nodiscard]] int flags(std::size_t line) const;

  // Chips that are open, of all nodes.
  [[nodiscard]] static int alive();

 private:
  friend struct FakeLibgpiod;
  struct Line;

  void tell(Line& line, bool is_high);

  std::string node_;
  std::string label_;
  std::vector<Line> lines_;
  std::uint64_t generation_{1};  // +1 with each unplug
  int edges_to_lose_{0};
  bool is_plugged_{true};
  bool is_failing_{false};
  bool is_failing_questions_{false};
  bool is_forbidden_{false};
  std::function<void(std::size_t)> before_answers_;
};

}  // namespace thimble::test
