#include "sim/export/verb.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <string>

namespace thimble::sim {
namespace {

struct Argument {
  double least{0};
  double most{0};
  double usual{0};
  bool is_whole{false};
};

constexpr Argument kMetres{-1, 1, 0};     // no arm here is longer
constexpr Argument kNewtons{-50, 50, 0};  // nor stronger
constexpr Argument kThreshold_newton{0, 50, 0};
constexpr Argument kStroke_s{0.001, 60, 1};  // the hand's shortest stroke is 1 ms
constexpr Argument kWhile_s{0, 3600, 1};
constexpr Argument kButton{0, 31, 0, true};
constexpr Argument kReports{0, 1e6, 1, true};

struct Rule {
  std::string_view word;
  VerbKind kind{};
  std::size_t required{0};
  std::size_t most{0};
  std::array<Argument, 4> arguments{};
  bool has_name{false};  // before its numbers
};

constexpr std::array<Rule, 20> kRules{{
    {"move", VerbKind::Move, 3, 4, {kMetres, kMetres, kMetres, kStroke_s}},
    {"home", VerbKind::Home, 0, 1, {kStroke_s}},
    {"let-go", VerbKind::LetGo, 0, 0, {}},
    {"push", VerbKind::Push, 3, 3, {kNewtons, kNewtons, kNewtons}},
    {"press", VerbKind::Press, 1, 1, {kButton}},
    {"release", VerbKind::Release, 1, 1, {kButton}},
    {"unplug", VerbKind::Unplug, 0, 0, {}},
    {"pull-cable", VerbKind::PullCable, 0, 0, {}},
    {"plug", VerbKind::Plug, 0, 0, {}},
    {"stall", VerbKind::Stall, 1, 1, {kWhile_s}},
    {"nak", VerbKind::Nak, 1, 1, {kWhile_s}},
    {"corrupt", VerbKind::Corrupt, 0, 1, {kReports}},
    {"short", VerbKind::Short, 0, 1, {kReports}},
    {"babble", VerbKind::Babble, 0, 1, {kReports}},
    {"short-out", VerbKind::ShortOut, 0, 1, {kReports}},
    {"halt", VerbKind::Halt, 0, 1, {kReports}},
    {"fault", VerbKind::Fault, 0, 1, {kReports}, true},
    {"status", VerbKind::Status, 0, 0, {}},
    {"log", VerbKind::Log, 0, 1, {kWhile_s}},
    {"felt", VerbKind::Felt, 0, 2, {kWhile_s, kThreshold_newton}},
}};

// Takes the next word off; empty at the end.
std::string_view take_word(std::string_view& line) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = line.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return line = {};
  line.remove_prefix(first);
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

std::optional<double> number_of(std::string_view word, const Argument& argument) {
  double number{0};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  // Written so that NaN does not pass.
  if (!(number >= argument.least && number <= argument.most)) return std::nullopt;
  if (argument.is_whole && number != std::floor(number)) return std::nullopt;
  return number;
}

tl::unexpected<Error> unknown_verb() {
  std::string known;
  for (const Rule& rule : kRules) known += " " + std::string(rule.word);
  return fail(Errc::InvalidArgument, "there is no such verb; there are:" + known);
}

Result<Verb> parse_numbers(const Rule& rule, std::string_view line) {
  Verb verb{.kind = rule.kind};
  if (rule.has_name) verb.name = take_word(line);
  if (rule.has_name && verb.name.empty()) {
    return fail(Errc::InvalidArgument, std::string(rule.word) + " takes a name");
  }
  std::size_t count = 0;
  for (; count < rule.most; ++count) {
    const Argument& argument = rule.arguments[count];
    verb.numbers[count] = argument.usual;
    const std::string_view word = take_word(line);
    if (word.empty()) break;
    const std::optional<double> number = number_of(word, argument);
    if (!number) {
      return fail(Errc::InvalidArgument, std::string(rule.word) + " takes numbers from " +
                                             std::to_string(argument.least) + " to " +
                                             std::to_string(argument.most) + ", not \"" +
                                             std::string(word) + "\"");
    }
    verb.numbers[count] = *number;
  }
  if (count < rule.required || !take_word(line).empty()) {
    return fail(Errc::InvalidArgument, std::string(rule.word) + " takes " +
                                           std::to_string(rule.required) + " to " +
                                           std::to_string(rule.most) + " numbers");
  }
  return verb;
}

}  // namespace

Result<Verb> parse_verb(std::string_view line) {
  if (line.size() > kMaxVerbBytes) return fail(Errc::TooLarge, "the line is too long");
  const std::string_view word = take_word(line);
  for (const Rule& rule : kRules) {
    if (rule.word == word) return parse_numbers(rule, line);
  }
  return unknown_verb();
}

}  // namespace thimble::sim
