#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thimble::test {

// A chip of the kernel's own gpio-sim, and what its lines are wired to. For a guest: it needs root,
// and the module, which Debian does not build (docs/decisions/0517).
//
// Interface: Documentation/admin-guide/gpio/gpio-sim.rst of Linux 6.1.
// Thread: one at a time. Errors: a failure of the test.
class GpioSimChip {
 public:
  // `names`: of its lines; one without a name is empty.
  GpioSimChip(const std::string& label, const std::vector<std::string>& names);
  ~GpioSimChip();
  GpioSimChip(const GpioSimChip&) = delete;
  GpioSimChip& operator=(const GpioSimChip&) = delete;

  void plug();
  void unplug();
  // Of an output of somebody's: what it shall be tied to when that ends.
  void set_wire(std::size_t line, bool is_high);
  [[nodiscard]] bool wire(std::size_t line) const;

 private:
  [[nodiscard]] std::filesystem::path line_folder(std::size_t line) const;

  std::filesystem::path device_;                // of configfs
  std::filesystem::path chip_;                  // of sysfs, while it is plugged in
  std::vector<std::filesystem::path> folders_;  // of configfs, in the order in which they were made
};

}  // namespace thimble::test
