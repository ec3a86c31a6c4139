#pragma once

#include "hal/base/result.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/rt/heartbeat.hpp"

namespace thimble::guard {

// The memory in which an arm's servo and its guard see each other.
//
// Thread: control thread; heartbeat() from any as long as the page lives.
// RT: reading and writing heartbeat() never leaves the process: the page is in memory from the
//     start and cannot shrink.
// Ownership: unmaps and closes. Errors: System; of map() also Malformed, for a file that another
// process could cut short under whoever reads it.
class SharedPage {
 public:
  [[nodiscard]] static Result<SharedPage> create();
  // Of a page that another process made.
  [[nodiscard]] static Result<SharedPage> map(linux::Descriptor page);
  SharedPage(SharedPage&& other) noexcept;
  SharedPage& operator=(SharedPage&&) = delete;
  ~SharedPage();

  [[nodiscard]] rt::Heartbeat& heartbeat() noexcept { return *heartbeat_; }
  [[nodiscard]] int descriptor() const noexcept { return page_.get(); }

 private:
  SharedPage(linux::Descriptor page, rt::Heartbeat* heartbeat) noexcept
      : page_(std::move(page)), heartbeat_(heartbeat) {}

  linux::Descriptor page_;
  rt::Heartbeat* heartbeat_;
};

}  // namespace thimble::guard
