#include "guard/shared_page.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <cerrno>
#include <string>

#include "hal/linux/system_error.hpp"

namespace thimble::guard {
namespace {

constexpr std::size_t kBytes = 4096;
// Who maps a file that shrinks is ended by SIGBUS at the next look.
constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;

}  // namespace

Result<SharedPage> SharedPage::create() {
  linux::Descriptor page(::memfd_create("thimble-heartbeat", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (page.get() < 0 || ::ftruncate(page.get(), kBytes) != 0 ||
      ::fcntl(page.get(), F_ADD_SEALS, kSeals) != 0) {
    return tl::unexpected(linux::system_error("no memory to share with a guard", errno));
  }
  return map(std::move(page));
}

Result<SharedPage> SharedPage::map(linux::Descriptor page) {
  struct stat file {};
  const int seals = ::fcntl(page.get(), F_GET_SEALS);
  if (::fstat(page.get(), &file) != 0 || seals < 0 || (seals & F_SEAL_SHRINK) == 0 ||
      file.st_size < static_cast<off_t>(kBytes)) {
    return fail(Errc::Malformed, "the page of the heartbeat is no sealed memory of 4096 bytes");
  }
  void* const memory =
      ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, page.get(), 0);
  if (memory == MAP_FAILED)
    return tl::unexpected(linux::system_error("cannot map the heartbeat", errno));
  // Zero bytes are a Heartbeat (C++20, implicit-lifetime: its members are scalars in effect).
  return SharedPage(std::move(page), static_cast<rt::Heartbeat*>(memory));
}

SharedPage::SharedPage(SharedPage&& other) noexcept
    : page_(std::move(other.page_)), heartbeat_(std::exchange(other.heartbeat_, nullptr)) {}

SharedPage::~SharedPage() {
  if (heartbeat_ != nullptr) ::munmap(heartbeat_, kBytes);
}

}  // namespace thimble::guard
