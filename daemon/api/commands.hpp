#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"

namespace thimble::api {

// One connection; never used twice while the daemon runs.
struct ClientId {
  std::uint64_t value{0};
  auto operator<=>(const ClientId&) const = default;
};

// A command that was carried out: how the arm stood when it had come true.
struct Done {
  std::string state;        // OperatingState in words
  std::string instruction;  // what the person has to do next; empty when nothing
};
using Answer = std::function<void(const Result<Done>&)>;

// Ours: enough for a scale to show even where the arm is a seventh as strong as it thinks.
inline constexpr double kMostSteady_newton = 8;

// Of a wave impedance, N·s/m: what a wave channel takes (coupling/wave_channel.hpp).
inline constexpr double kLeastImpedance_newton_s_per_m = 0.1;
inline constexpr double kMostImpedance_newton_s_per_m = 40;

// A change of a world's cells, as docs/api.md has it. World frame: where an arm's hand plus its
// coordinate offset is; the origin is the middle of the world, cell {0, 0, 0} its corner where x, y
// and z are least.
struct CellEdit {
  enum class Kind : std::uint8_t { Fill, Box, Paint };
  Kind kind{Kind::Fill};
  std::array<std::int32_t, 3> min{};  // Fill, Box; ends included
  std::array<std::int32_t, 3> max{};
  std::array<double, 3> center_m{};  // Paint
  double radius_m{0};
  std::uint8_t cell{1};  // 0 free, 1 filled, 1 + n of the n-th material
  bool operator==(const CellEdit&) const = default;
};
// Edits that are in the world now.
struct Edited {
  std::size_t edits{0};
  std::uint64_t changed_cells{0};
};
using EditAnswer = std::function<void(const Result<Edited>&)>;

// What is asked of an arm's world in the name of its hand, wherever that world is.
enum class HandVerb : std::uint8_t { Free, Reset };

// What is done to the pieces of a world on a board, where the hand is now.
enum class PieceVerb : std::uint8_t { Select, Drop, Delete, Free, Reset };
struct PieceDone {
  std::string outcome;  // in words: "selected", "no room" …
  bool is_done{false};  // false: the world is as it was, and the words say why
};
using PieceAnswer = std::function<void(const Result<PieceDone>&)>;

// A world's cells or its state, as an NRRD file.
using FileAnswer = std::function<void(const Result<std::string>&)>;
// Of a state that was put back the steps that it had taken.
using LoadAnswer = std::function<void(const Result<std::uint64_t>&)>;

// What a client may ask of the daemon. An arm that a client activated is that client's lease:
// client_gone() must release it.
//
// Thread: the net thread; must not block. What takes the servo's time is answered later: each
// `answer` is called once, within the call or within a bounded time, and not after
// client_gone() of its client.
// Errors: NotFound for an unknown arm or world, Busy when the state or another lease forbids it,
//         Disconnected for a lost arm or a link that is down, Timeout when it did not come true in
//         time, Unsupported for a world that cannot be edited, or has no pieces, InvalidArgument
//         for edits that its cells forbid, TooLarge for more of them than one request may bring.
class Commands {
 public:
  virtual ~Commands() = default;
  virtual void activate(std::string_view arm, ClientId client, Answer answer) = 0;
  virtual void deactivate(std::string_view arm, ClientId client, Answer answer) = 0;
  // `fault`: the FaultStatus::number that is meant; nothing: whichever is latched now.
  virtual void clear_fault(std::string_view arm, std::optional<std::uint32_t> fault,
                           ClientId client, Answer answer) = 0;
  // Has an active arm push straight up (below 0: down) with so many newtons, at most
  // kMostSteady_newton, through its limiter, instead of what its world says; nothing: no more. Only
  // for who holds the arm's lease; ends with it, with the client, and after a minute.
  virtual void steady_force(std::string_view arm, std::optional<double> up_newton, ClientId client,
                            Answer answer) = 0;
  // Tunes how an arm of the scheme "wave" feels, within what is above: pencil to heavy drill. Needs
  // no lease: it moves nothing. Stays until the arm leaves. Unsupported: another scheme.
  virtual void set_impedance(std::string_view arm, double newton_s_per_m, Answer answer) = 0;
  // Needs no lease, as what is done to pieces. Answered when it was asked: what becomes of it shows
  // where the world is. Unsupported: a carriage that cannot say it, a world that does not do it.
  virtual void ask_world(std::string_view arm, HandVerb verb, Answer answer) = 0;
  // Needs no lease (0196). All of the edits or none, some 4 s of work at most (EditQueue). Answered
  // when the last of them is applied; a client that goes meanwhile takes them back as long as none
  // has begun.
  virtual void edit_world(std::string_view world, const std::vector<CellEdit>& edits,
                          ClientId client, EditAnswer answer) = 0;
  // Needs no lease, as edits. Answered when the board has done it; what it could not do is no
  // error.
  virtual void act_on_pieces(std::string_view world, PieceVerb verb, ClientId client,
                             PieceAnswer answer) = 0;
  // What its cells are, in bytes: 1 where there is matter, of pieces their numbers. No lease. As
  // the two below answered in its turn: many who ask for much wait for each other.
  virtual void read_cells(std::string_view world, ClientId client, FileAnswer answer) = 0;
  // The state of a world that runs by itself, as a file (docs/worlds/live.md); and one put back:
  // how many steps it had taken. Neither needs a lease; both are done in one go, and what was asked
  // by a client that goes before its turn is not done. Errors: also Malformed for bytes that are no
  // state.
  virtual void save_world(std::string_view world, ClientId client, FileAnswer answer) = 0;
  virtual void load_world(std::string_view world, std::string state, ClientId client,
                          LoadAnswer answer) = 0;
  // Called once for every client that sent a command, after its last one.
  virtual void client_gone(ClientId client) = 0;
};

}  // namespace thimble::api
