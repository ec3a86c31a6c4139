#include "daemon/app/serial_lines.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include "hal/linux/background_worker.hpp"

namespace thimble::app {
namespace {

using Worker = std::shared_ptr<linux::BackgroundWorker>;
using Answer = std::promise<Result<link::LineNode>>;

// The same file, let go of in the worker's thread.
link::LineNode closed_by(const Worker& worker, link::LineNode node) {
  const int* const file = node.get();
  return {file, [worker, held = std::move(node)](const int*) mutable {
            worker->post([held = std::exchange(held, nullptr)] {});
          }};
}

Result<link::LineNode> open_within(const Worker& worker, const SerialLines::Open& open,
                                   const std::string& node, std::uint32_t bit_per_s) {
  try {
    Result<link::LineNode> opened = open(node, bit_per_s);
    if (!opened) return opened;
    return closed_by(worker, *std::move(opened));
  } catch (const std::exception& error) {
    return fail(Errc::System, node + " cannot be opened: " + error.what());
  }
}

}  // namespace

SerialLines::SerialLines(Open open) : open_(std::move(open)) {}
SerialLines::~SerialLines() = default;

std::future<Result<link::LineNode>> SerialLines::open(const std::string& node,
                                                      std::uint32_t bit_per_s) {
  // Shared, for a task can be copied.
  const auto answer = std::make_shared<Answer>();
  try {
    Worker& worker = workers_[node];
    if (worker == nullptr) worker = std::make_shared<linux::BackgroundWorker>();
    worker->post([answer, open = open_, node, bit_per_s, worker] {
      answer->set_value(open_within(worker, open, node, bit_per_s));
    });
  } catch (const std::exception& error) {
    answer->set_value(fail(Errc::System, "no thread to open " + node + " in: " + error.what()));
  }
  return answer->get_future();
}

std::vector<std::string> SerialLines::late_after(Duration patience, const Clock& clock) {
  const MonotonicTime deadline = clock.now() + patience;
  std::vector<std::string> late;
  for (const auto& [node, worker] : workers_) {
    const Duration rest = std::max(Duration(0), deadline - clock.now());
    if (worker != nullptr && !worker->wait(rest)) late.push_back(node);
  }
  return late;
}

}  // namespace thimble::app
