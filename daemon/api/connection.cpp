#include "daemon/api/connection.hpp"

#include <boost/json.hpp>
#include <utility>

#include "daemon/api/json_text.hpp"

namespace thimble::api {
namespace {

namespace http = boost::beast::http;

constexpr unsigned kHttp11 = 11;
constexpr std::string_view kJson = "application/json";
constexpr std::string_view kBytes = "application/octet-stream";

RequestError refusal_of(boost::beast::error_code error) {
  if (error == http::error::header_limit) {
    return {431, "too-large", "the header is larger than this server reads", ""};
  }
  if (error == http::error::body_limit) {
    return {413, "too-large", "the body is larger than this server reads", ""};
  }
  return {400, "malformed", "this is no HTTP/1.1 request", ""};
}

// What the parser says about bytes, as opposed to what the socket says about itself.
bool is_about_bytes(boost::beast::error_code error) {
  return error.category() == http::make_error_code(http::error::bad_method).category() &&
         error != http::error::end_of_stream && error != http::error::partial_message;
}

}  // namespace

Connection::Connection(Socket socket, ClientId id, Context context)
    : stream_(std::move(socket)),
      id_(id),
      context_(std::move(context)),
      buffer_(context_.settings.max_header_bytes + context_.settings.max_body_bytes) {}

void Connection::close() {
  if (std::exchange(is_closed_, true)) return;
  stream_.close();
  if (has_commanded_) context_.commands.client_gone(id_);
  context_.on_closed(id_);
}

bool Connection::holds_lease() const {
  // Somebody else may have ended it since.
  for (const auto& [arm, number] : leases_) {
    if (lease_of(arm).number == number) return true;
  }
  return false;
}

void Connection::read() {
  parser_.emplace();
  parser_->header_limit(static_cast<std::uint32_t>(context_.settings.max_header_bytes));
  parser_->body_limit(context_.settings.max_state_bytes);  // until it is known for what it is
  stream_.expires_after(context_.settings.idle_timeout);
  if (holds_lease() || has_pushed_) stream_.expires_never();
  http::async_read_header(stream_, buffer_, *parser_,
                          [self = shared_from_this()](boost::beast::error_code error, std::size_t) {
                            self->on_header(error);
                          });
}

void Connection::on_header(boost::beast::error_code error) {
  if (is_closed_ || error) return on_read(error);
  const auto target = parser_->get().target();
  const std::size_t limit = may_bring_state({target.data(), target.size()})
                                ? context_.settings.max_state_bytes
                                : context_.settings.max_body_bytes;
  if (parser_->content_length().value_or(0) > limit) return on_read(http::error::body_limit);
  parser_->body_limit(limit);
  http::async_read(stream_, buffer_, *parser_,
                   [self = shared_from_this()](boost::beast::error_code read_error, std::size_t) {
                     self->on_read(read_error);
                   });
}

void Connection::on_read(boost::beast::error_code error) {
  if (is_closed_) return;
  if (error) {
    if (is_about_bytes(error)) return answer_and_close(refusal_of(error));
    return close();
  }
  context_.on_moved(id_);
  perform(parser_->release());
}

void Connection::respond(tl::expected<std::string, RequestError> body, bool is_kept,
                         std::string_view content_type) {
  if (body) {
    prepare(200, std::move(*body), is_kept, content_type);
  } else {
    prepare(body.error().http_status, to_json(body.error()), is_kept, kJson);
    if (!body.error().allow.empty()) response_.set(http::field::allow, body.error().allow);
  }
  write(is_kept);
}

void Connection::answer_and_close(const RequestError& error) {
  prepare(error.http_status, to_json(error), false, kJson);
  write(false);
}

void Connection::prepare(unsigned status, std::string body, bool is_kept,
                         std::string_view content_type) {
  response_ = Response(static_cast<http::status>(status), kHttp11);
  response_.set(http::field::content_type, {content_type.data(), content_type.size()});
  response_.keep_alive(is_kept);
  response_.body() = std::move(body);
  response_.prepare_payload();
}

void Connection::write(bool is_kept) {
  stream_.expires_after(context_.settings.write_timeout);
  http::async_write(
      stream_, response_,
      [self = shared_from_this(), is_kept](boost::beast::error_code error, std::size_t) {
        if (self->is_closed_) return;
        if (error || !is_kept) return self->close();
        self->context_.on_moved(self->id_);
        self->read();
      });
}

void Connection::perform(const Request& request) {
  const bool is_kept = request.keep_alive();
  auto action = parse_request({request.method_string().data(), request.method_string().size()},
                              {request.target().data(), request.target().size()}, request.body());
  if (!action) return respond(tl::unexpected(std::move(action.error())), is_kept);
  if (action->kind == ActionKind::Status) return respond(to_json(context_.view.status()), is_kept);
  command(*std::move(action), is_kept);
}

// Nothing is read while a command waits for its answer; a client that goes meanwhile takes it back,
// and its place is free at once. One that only ends its own direction still gets the answer.
void Connection::watch_for_hang_up() {
  stream_.socket().async_wait(Socket::wait_error,
                              [self = shared_from_this()](boost::beast::error_code error) {
                                if (!error) self->close();
                              });
}

void Connection::command(Action action, bool is_kept) {
  if (!std::exchange(has_commanded_, true)) watch_for_hang_up();
  // Nothing is read before the answer, so there is never more than one under way.
  if (action.kind == ActionKind::EditWorld) {
    return context_.commands.edit_world(
        action.name, action.edits, id_,
        [self = shared_from_this(), world = action.name, is_kept](const Result<Edited>& edited) {
          self->on_edited(world, edited, is_kept);
        });
  }
  if (action.kind == ActionKind::ReadCells) {
    return context_.commands.read_cells(action.name, id_, file_answer(is_kept));
  }
  if (action.kind == ActionKind::SaveWorld) {
    return context_.commands.save_world(action.name, id_, file_answer(is_kept));
  }
  if (action.kind == ActionKind::LoadWorld) {
    return context_.commands.load_world(
        action.name, std::move(action.state), id_,
        [self = shared_from_this(), world = action.name,
         is_kept](const Result<std::uint64_t>& steps) { self->on_loaded(world, steps, is_kept); });
  }
  if (action.kind == ActionKind::ActOnPieces) {
    return context_.commands.act_on_pieces(
        action.name, action.piece_verb, id_,
        [self = shared_from_this(), world = action.name, is_kept](const Result<PieceDone>& done) {
          self->on_pieces(world, done, is_kept);
        });
  }
  const auto answer = [self = shared_from_this(), action, is_kept](const Result<Done>& done) {
    self->on_done(action, done, is_kept);
  };
  if (action.kind == ActionKind::Activate) {
    context_.commands.activate(action.name, id_, answer);
  } else if (action.kind == ActionKind::Deactivate) {
    context_.commands.deactivate(action.name, id_, answer);
  } else if (action.kind == ActionKind::SteadyForce) {
    context_.commands.steady_force(action.name, action.up_newton, id_, answer);
  } else if (action.kind == ActionKind::SetImpedance) {
    context_.commands.set_impedance(action.name, action.newton_s_per_m, answer);
  } else if (action.kind == ActionKind::AskWorld) {
    context_.commands.ask_world(action.name, action.hand_verb, answer);
  } else {
    context_.commands.clear_fault(action.name, action.fault, id_, answer);
  }
}

void Connection::on_done(const Action& action, const Result<Done>& done, bool is_kept) {
  if (is_closed_) return;  // the command ended the server
  if (!done) return respond(tl::unexpected(to_request_error(done.error())), is_kept);
  const Lease lease = lease_of(action.name);
  if (action.kind == ActionKind::Activate && lease.holder == "client") {
    leases_[action.name] = lease.number;
  }
  if (action.kind == ActionKind::Deactivate) leases_.erase(action.name);
  // Of an arm that the configuration holds, too. The force itself ends after a minute.
  has_pushed_ = action.kind == ActionKind::SteadyForce && action.up_newton.has_value();
  respond(to_text(boost::json::object{{"arm", action.name},
                                      {"lease", lease.holder},
                                      {"lease_number", lease.number},
                                      {"state", done->state},
                                      {"instruction", done->instruction}}),
          is_kept);
}

void Connection::on_edited(const std::string& world, const Result<Edited>& edited, bool is_kept) {
  if (is_closed_) return;
  if (!edited) return respond(tl::unexpected(to_request_error(edited.error())), is_kept);
  respond(
      to_text(boost::json::object{
          {"world", world}, {"edits", edited->edits}, {"changed_cells", edited->changed_cells}}),
      is_kept);
}

void Connection::on_loaded(const std::string& world, const Result<std::uint64_t>& steps,
                           bool is_kept) {
  if (is_closed_) return;
  if (!steps) return respond(tl::unexpected(to_request_error(steps.error())), is_kept);
  respond(to_text(boost::json::object{{"world", world}, {"steps", *steps}}), is_kept);
}

FileAnswer Connection::file_answer(bool is_kept) {
  return [self = shared_from_this(), is_kept](const Result<std::string>& file) {
    if (self->is_closed_) return;
    if (!file) return self->respond(tl::unexpected(to_request_error(file.error())), is_kept);
    self->respond(*file, is_kept, kBytes);
  };
}

void Connection::on_pieces(const std::string& world, const Result<PieceDone>& done, bool is_kept) {
  if (is_closed_) return;
  if (!done) return respond(tl::unexpected(to_request_error(done.error())), is_kept);
  respond(to_text(boost::json::object{
              {"world", world}, {"outcome", done->outcome}, {"is_done", done->is_done}}),
          is_kept);
}

Connection::Lease Connection::lease_of(const std::string& arm) const {
  for (const ArmStatus& status : context_.view.status().arms) {
    if (status.name == arm) return {status.lease, status.lease_number};
  }
  return {};
}

}  // namespace thimble::api
