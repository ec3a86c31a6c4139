#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "drivers/cambus/step_list_check.hpp"
#include "drivers/cambus/step_list_text.hpp"

// Any bytes give a list that stays within them, or a reason; and a text that ends.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace cambus = thimble::cambus;
  const auto list = cambus::parse_list_file({reinterpret_cast<const char*>(data), size});
  if (!list) return 0;
  const cambus::WindowView window = list->view();
  const auto summary = cambus::check_step_list(window, list->head);
  if (cambus::disassemble(window, list->head).empty()) std::abort();
  if (!summary) return 0;
  std::uint32_t at = list->head;
  for (std::uint32_t i = 0; i < summary->steps; ++i) {
    const auto step = cambus::descriptor_at(window, at);
    if (!step) std::abort();
    const bool has_buffer = step->buffer_bytes() > 0;
    if (has_buffer && !cambus::holds(window, step->buffer, step->buffer_bytes())) std::abort();
    if (step->has(cambus::wire::kStop)) return 0;
    at = step->link;
  }
  if (!summary->loops) std::abort();
  return 0;
}
