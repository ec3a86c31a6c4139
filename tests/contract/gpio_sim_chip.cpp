#include "tests/contract/gpio_sim_chip.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <system_error>

namespace thimble::test {
namespace {

namespace fs = std::filesystem;

const fs::path kChips = "/sys/kernel/config/gpio-sim";

// An attribute of configfs or sysfs takes what comes in one write.
void write(const fs::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text << std::flush;
  EXPECT_TRUE(out.good()) << file << ": " << text;
}

std::string read(const fs::path& file) {
  std::ifstream in(file);
  std::string text;
  EXPECT_TRUE(std::getline(in, text)) << file;
  return text;
}

}  // namespace

GpioSimChip::GpioSimChip(const std::string& label, const std::vector<std::string>& names)
    : device_(kChips / label) {
  const fs::path bank = device_ / "bank0";
  folders_ = {device_, bank};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!names[i].empty()) folders_.push_back(bank / ("line" + std::to_string(i)));
  }
  for (const fs::path& folder : folders_) EXPECT_TRUE(fs::create_directory(folder)) << folder;
  write(bank / "num_lines", std::to_string(names.size()));
  write(bank / "label", label);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!names[i].empty()) write(bank / ("line" + std::to_string(i)) / "name", names[i]);
  }
  plug();
}

GpioSimChip::~GpioSimChip() {
  if (!chip_.empty()) unplug();
  for (auto folder = folders_.rbegin(); folder != folders_.rend(); ++folder) {
    std::error_code error;
    fs::remove(*folder, error);
    EXPECT_FALSE(error) << *folder << ": " << error.message();
  }
}

void GpioSimChip::plug() {
  write(device_ / "live", "1");
  chip_ = fs::path("/sys/devices/platform") / read(device_ / "dev_name") /
          read(device_ / "bank0" / "chip_name");
}

void GpioSimChip::unplug() {
  write(device_ / "live", "0");
  chip_.clear();
}

fs::path GpioSimChip::line_folder(std::size_t line) const {
  return chip_ / ("sim_gpio" + std::to_string(line));
}

void GpioSimChip::set_wire(std::size_t line, bool is_high) {
  write(line_folder(line) / "pull", is_high ? "pull-up" : "pull-down");
}

bool GpioSimChip::wire(std::size_t line) const {
  return !chip_.empty() && read(line_folder(line) / "value") == "1";
}

}  // namespace thimble::test
