#include "daemon/safety/chain_status.hpp"

namespace thimble::safety {

std::string_view to_string(ChainTrouble trouble) noexcept {
  switch (trouble) {
    case ChainTrouble::None:
      return "none";
    case ChainTrouble::NoLines:
      return "no-lines";
    case ChainTrouble::Silent:
      return "silent";
    case ChainTrouble::OutputStuck:
      return "output-stuck";
    case ChainTrouble::EdgesLost:
      return "edges-lost";
    case ChainTrouble::Open:
      return "open";
    case ChainTrouble::Disagree:
      return "disagree";
    case ChainTrouble::Unwatched:
      return "unwatched";
    case ChainTrouble::ArmOutOfReach:
      return "arm-out-of-reach";
    case ChainTrouble::EnablePaused:
      return "enable-paused";
  }
  return "unknown";
}

std::string_view explain(ChainTrouble trouble) noexcept {
  switch (trouble) {
    case ChainTrouble::None:
      return "";
    case ChainTrouble::NoLines:
      return "the safety lines are not there; plug their adapter in";
    case ChainTrouble::Silent:
      return "the chip of the safety lines does not answer; look at its cable";
    case ChainTrouble::OutputStuck:
      return "the chip of the safety lines takes no output; look at its cable";
    case ChainTrouble::EdgesLost:
      return "a safety line changed unseen; look for a loose contact";
    case ChainTrouble::Open:
      return "the emergency stop is pressed, or its wire is broken";
    case ChainTrouble::Disagree:
      return "the two channels of the emergency stop disagree; press it and release it, and if "
             "this stays look for a welded contact or a broken wire";
    case ChainTrouble::Unwatched:
      return "the safety lines were not looked after in time; this machine is too busy";
    case ChainTrouble::ArmOutOfReach:
      return "an arm without a watchdog may hold a force and is out of reach, so ENABLE has "
             "stopped to cut the motors' power; look at that arm, then clear";
    case ChainTrouble::EnablePaused:
      return "ENABLE paused, so the motors' power may have been cut; look at the arms, then clear";
  }
  return "";
}

std::string_view recall(ChainTrouble trouble) noexcept {
  switch (trouble) {
    case ChainTrouble::None:
      return "";
    case ChainTrouble::NoLines:
      return "the safety lines were not there";
    case ChainTrouble::Silent:
      return "their chip did not answer";
    case ChainTrouble::OutputStuck:
      return "their chip took no output";
    case ChainTrouble::EdgesLost:
      return "a safety line changed unseen";
    case ChainTrouble::Open:
      return "the emergency stop was pressed, or its wire broken";
    case ChainTrouble::Disagree:
      return "the two channels of the emergency stop disagreed";
    case ChainTrouble::Unwatched:
      return "they were not looked after in time";
    case ChainTrouble::ArmOutOfReach:
      return "an arm was out of reach and may hold a force, so ENABLE stopped; look at that arm";
    case ChainTrouble::EnablePaused:
      return "ENABLE paused, so the motors' power may have been cut; look at the arms";
  }
  return "";
}

}  // namespace thimble::safety
