#include "cli/commands.hpp"

#include <cstdio>
#include <iostream>
#include <iterator>
#include <memory>

#include "cli/ask.hpp"
#include "cli/cells.hpp"
#include "cli/client.hpp"
#include "cli/command_reply.hpp"
#include "cli/file_text.hpp"
#include "cli/interrupts.hpp"
#include "cli/render.hpp"
#include "cli/status_document.hpp"
#include "cli/terminal.hpp"
#include "cli/text.hpp"
#include "daemon/world/cam/automaton_file.hpp"

namespace thimble::cli {
namespace {

constexpr double kLeaseLook_s = 0.5;
constexpr std::size_t kMaxReportBytes = std::size_t{1} << 22;

// A person's file that is not there is no daemon that is not there: the exit code is another.
int complain_of_file(const std::string& file, const Error& error) {
  std::cerr << "thimble: " << plain(file) << ": " << error.message << '\n';
  return kExitRefused;
}

// All of a file that is to have so many bytes at most. `kind` is what it is to be.
Result<std::string> read_bounded(const std::string& file, std::size_t most_bytes,
                                 const std::string& kind) {
  auto text = read_at_most(file, most_bytes + 1);
  if (!text || text->size() <= most_bytes) return text;
  return fail(Errc::TooLarge, "has more than " + std::to_string(most_bytes >> 10) +
                                  " KiB, which no " + kind + " has");
}

int hold_lease(Client& client, const CommandReply& reply) {
  Interrupts interrupts;  // before the words: who reads them may interrupt at once
  std::cout << render_reply("activate", reply) << "; Ctrl-C releases it" << std::endl;
  while (true) {
    const Interrupts::Woken woken = interrupts.wait(client.descriptor(), kLeaseLook_s);
    if (woken == Interrupts::Woken::Signal) {
      std::cout << "arm " << reply.arm << " is released\n";
      return kExitOk;
    }
    // Anybody may deactivate it, and the daemon tells only who asks.
    const auto status = ask_status(client);
    if (!status) {
      return complain(
          {status.error().code, status.error().message + "; arm " + reply.arm + " is released"});
    }
    if (!still_stands(reply, *status)) {
      return complain({Errc::Busy, "arm " + reply.arm + " was deactivated"});
    }
  }
}

// One picture of the daemon. On a terminal it takes the place of the one before.
Result<void> show(Client& client, Screen& screen) {
  auto status = ask_status(client);
  if (!status) return tl::unexpected<Error>(status.error());
  if (screen.is_terminal()) {
    screen.draw(render_watch(*status, screen.glyphs(), screen.rows()));
  } else {
    std::cout << render_line(*status) << std::flush;
  }
  return {};
}

// Who asks seldom may find the connection closed, and asks on a new one, which takes its place.
Result<void> show_again(const std::string& socket_path, std::unique_ptr<Client>& client,
                        Screen& screen) {
  Result<void> shown = show(*client, screen);
  if (shown || shown.error().code != Errc::Disconnected) return shown;
  auto anew = connect_to_daemon(socket_path);
  if (!anew) return shown;
  client = *std::move(anew);
  return show(*client, screen);
}

}  // namespace

Result<api::Status> daemon_status(const std::string& socket_path) {
  auto client = connect_to_daemon(socket_path);
  if (!client) return tl::unexpected<Error>(client.error());
  return ask_status(**client);
}

int run_status(const std::string& socket_path, bool is_json) {
  auto client = connect_to_daemon(socket_path);
  if (!client) return complain(client.error());
  auto body = ask(**client, "GET", "/v1/status");
  if (!body) return complain(body.error());
  if (is_json) {
    std::cout << *body;
    return kExitOk;
  }
  auto status = parse_status(*body);
  if (!status) return complain(status.error());
  std::cout << render_status(*status, glyphs_of_environment());
  return kExitOk;
}

int run_watch(const std::string& socket_path, const WatchOptions& options) {
  auto client = connect_to_daemon(socket_path);
  if (!client) return complain(client.error());
  Interrupts interrupts;  // only now: a signal shall end the waiting for a connection
  Result<void> shown;
  {
    Screen screen;
    for (double time_s = 0; !options.for_s || time_s < *options.for_s;
         time_s += options.interval_s) {
      shown = show_again(socket_path, *client, screen);
      if (!shown || !std::cout) break;
      if (interrupts.wait(-1, options.interval_s) == Interrupts::Woken::Signal) break;
    }
  }
  return shown ? kExitOk : complain(shown.error());
}

int run_command(const std::string& socket_path, const std::string& verb, const std::string& arm,
                const std::string& body) {
  auto client = connect_to_daemon(socket_path);
  if (!client) return complain(client.error());
  const Result<std::string> name = arm.empty() ? only_arm(**client) : Result<std::string>(arm);
  if (!name) return complain(name.error());
  const auto answer = ask(**client, "POST", "/v1/arms/" + *name + "/" + verb, body);
  if (!answer) return complain(answer.error());
  const Result<CommandReply> reply = parse_command_reply(*answer, *name);
  if (!reply) return complain(reply.error());
  if (verb == "activate" && reply->lease == "client") return hold_lease(**client, *reply);
  std::cout << render_reply(verb, *reply) << '\n';
  return kExitOk;
}

int run_world_edit(const std::string& socket_path, const std::string& world,
                   const WorldEdit& edit) {
  auto client = connect_to_daemon(socket_path);
  if (!client) return complain(client.error());
  const auto meant = ask_for_world(**client, world);
  if (!meant) return complain(meant.error());
  const auto body = ask(**client, "POST", "/v1/worlds/" + meant->name + "/edits",
                        body_of(edit, meant->cells), kEditTimeout);
  if (!body) return complain(body.error());
  const Result<std::uint64_t> changed = parse_changed_cells(*body, meant->name);
  if (!changed) return complain(changed.error());
  std::cout << "world " << plain(meant->name) << ": " << *changed
            << (*changed == 1 ? " cell changed\n" : " cells changed\n");
  return kExitOk;
}

namespace {

// Where pieces are, as a layout that `world.pieces.layout` reads.
int save_layout(Client& client, const api::WorldStatus& world, const std::string& file) {
  if (!file.ends_with(".npy") && !file.ends_with(".nrrd")) {
    return complain_of_file(
        file, {Errc::InvalidArgument, "a layout is written to a file ending in .npy or .nrrd"});
  }
  const auto body = ask(client, "GET", "/v1/worlds/" + world.name + "/cells");
  if (!body) return complain(body.error());
  const auto layout = parse_cells(*body).map(without_particles);
  if (!layout) return complain(layout.error());
  const auto written =
      write_whole(file, file.ends_with(".npy") ? to_npy(*layout) : to_nrrd(*layout));
  if (!written) return complain_of_file(file, written.error());
  std::cout << "world " << plain(world.name) << ": layout saved to " << plain(file) << '\n';
  return kExitOk;
}

}  // namespace

int run_world_state(const std::string& socket_path, const std::string& world,
                    const WorldEdit& edit) {
  auto client = connect_to_daemon(socket_path);
  if (!client) return complain(client.error());
  const auto meant = ask_for_world(**client, world);
  if (!meant) return complain(meant.error());
  const bool is_load = edit.verb == "load";
  if (!is_load && meant->pieces) return save_layout(**client, *meant, edit.file);
  const Result<std::string> state =
      is_load ? read_bounded(edit.file, world::cam::kMaxStateBytes, "saved state")
              : Result<std::string>("");
  if (!state) return complain_of_file(edit.file, state.error());
  const auto body =
      ask(**client, is_load ? "PUT" : "GET", "/v1/worlds/" + meant->name + "/state", *state);
  if (!body) return complain(body.error());
  const Result<void> checked =
      is_load ? check_loaded_state(*body, meant->name) : check_saved_state(*body, meant->name);
  if (!checked) return complain(checked.error());
  if (!is_load) {
    if (const auto written = write_whole(edit.file, *body); !written) {
      return complain_of_file(edit.file, written.error());
    }
  }
  std::cout << "world " << plain(meant->name) << (is_load ? ": goes on from " : ": saved to ")
            << plain(edit.file) << '\n';
  return kExitOk;
}

int run_piece_action(const std::string& socket_path, const std::string& verb,
                     const std::string& name) {
  auto client = Client::connect(socket_path);
  if (!client) return complain(client.error());
  const auto status = ask_status(**client);
  if (!status) return complain(status.error());
  if (const auto arm = arm_that_asks(*status, verb, name)) {
    return run_command(socket_path, verb, *arm);
  }
  const auto meant = find_world(*status, name);
  if (!meant) return complain(meant.error());
  const auto body = ask(**client, "POST", "/v1/worlds/" + meant->name + "/" + verb);
  if (!body) return complain(body.error());
  const Result<PieceReply> reply = parse_piece_reply(*body, meant->name);
  if (!reply) return complain(reply.error());
  std::cout << "world " << plain(meant->name) << ": " << reply->outcome << '\n';
  return reply->is_done ? kExitOk : kExitRefused;
}

int run_report(const std::string& file) {
  const Result<std::string> text = read_bounded(file, kMaxReportBytes, "summary of thimbled");
  if (!text) return complain_of_file(file, text.error());
  const auto status = parse_status(*text);
  if (!status) {
    std::cerr << "thimble: " << plain(file) << " is no summary of thimbled\n";
    return kExitRefused;
  }
  std::cout << render_report(*status, glyphs_of_environment());
  return kExitOk;
}

}  // namespace thimble::cli
