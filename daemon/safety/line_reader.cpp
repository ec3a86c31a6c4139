#include "daemon/safety/line_reader.hpp"

namespace thimble::safety {

void LineReader::restart() noexcept {
  memory_ = {};
  levels_ = {};
}

ChainTrouble LineReader::step(bus::GpioLines& lines, MonotonicTime now) noexcept {
  for (Input& input : memory_) {
    const bool is_known = input.by_edge.has_value();
    input.was_high = is_known ? *input.by_edge || input.by_level : true;
    input.was_low = is_known ? !*input.by_edge || !input.by_level : true;
  }
  bool is_whole = take_edges(lines);
  bus::GpioLevels levels;
  const IoStatus status = lines.levels(levels);
  if (status == IoStatus::Disconnected) return ChainTrouble::NoLines;
  if (status != IoStatus::Ok || now - levels.read_at > kSilence) return ChainTrouble::Silent;
  levels_ = levels;
  for (std::size_t i = 0; i < inputs_; ++i) {
    Input& input = memory_.at(i);
    input.by_level = levels.is_high(i);
    is_whole = compare(input, now) && is_whole;
  }
  return is_whole ? ChainTrouble::None : ChainTrouble::EdgesLost;
}

bool LineReader::was_always(std::size_t input, bool is_high) const noexcept {
  const Input& asked = memory_.at(input);
  return is_high ? !asked.was_low : !asked.was_high;
}

// False when some were lost.
bool LineReader::take_edges(bus::GpioLines& lines) noexcept {
  bool is_whole = true;
  bus::GpioEdge edge;
  IoStatus status = IoStatus::Ok;
  // A line that chatters must not hold this up. Ours: twice what GpioMailboxes keeps.
  constexpr int kMostAtOnce = 512;
  for (int i = 0; i < kMostAtOnce && status != IoStatus::NoData; ++i) {
    status = lines.next_edge(edge);
    if (status == IoStatus::Disconnected) return is_whole;  // the levels say so, too
    if (status == IoStatus::ProtocolError) is_whole = false;
    if (status != IoStatus::Ok || edge.input >= inputs_) continue;
    Input& input = memory_.at(edge.input);
    is_whole = is_whole && edge.sequence == input.sequence + 1;
    input.sequence = edge.sequence;
    input.by_edge = edge.is_high;
    (edge.is_high ? input.was_high : input.was_low) = true;
  }
  return is_whole;
}

// Edge and level are told on two ways and may differ for a while, not for long.
bool LineReader::compare(Input& input, MonotonicTime now) noexcept {
  if (!input.by_edge) {  // since it was opened: the first reading stands for the first edge
    input.by_edge = input.by_level;
    input.was_high = input.by_level;
    input.was_low = !input.by_level;
  }
  (input.by_level ? input.was_high : input.was_low) = true;
  if (*input.by_edge == input.by_level) {
    input.differs_since.reset();
    return true;
  }
  if (!input.differs_since) input.differs_since = now;
  if (now - *input.differs_since <= kEdgePatience) return true;
  input.by_edge = input.by_level;  // told once: the latch remembers it
  input.differs_since.reset();
  return false;
}

}  // namespace thimble::safety
