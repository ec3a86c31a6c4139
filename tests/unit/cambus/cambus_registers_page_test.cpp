#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/cambus/register_words.hpp"

// The table of registers in docs/cambus.md, section 2, that a board is built from, beside the
// registers that driver and simulator are built from.
namespace thimble::cambus {
namespace {

using Texts = std::vector<std::string>;

std::string page_text() {
  std::ifstream file(THIMBLE_SOURCE_DIR "/docs/cambus.md");
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string without_blanks_around(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

Texts parts_of(const std::string& text, char between) {
  Texts parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, between);) {
    parts.push_back(without_blanks_around(part));
  }
  return parts;
}

std::string before(const std::string& text, const std::string& end) {
  return text.substr(0, text.find(end));
}

// The cells of each row of section 2: number, name, bits, fields, wait, default.
std::vector<Texts> rows_of(const std::string& page) {
  const std::size_t section = page.find("## 2. Registers");
  std::vector<Texts> rows;
  std::istringstream in(page.substr(section, page.find("\n## 3.", section) - section));
  for (std::string text; std::getline(in, text);) {
    if (!text.starts_with("| ") || text.starts_with("| no.")) continue;
    Texts cells = parts_of(text.substr(1), '|');
    if (cells.size() == 6) rows.push_back(cells);
  }
  return rows;
}

// "a0 to a3": each of them.
Texts expanded(const std::string& item) {
  const std::size_t to = item.find(" to ");
  if (to == std::string::npos) return {item};
  const int last = std::stoi(item.substr(to + 5));
  Texts names;
  for (int i = std::stoi(item.substr(1, to)); i <= last; ++i) {
    names.push_back(item[0] + std::to_string(i));
  }
  return names;
}

// "select 2, map 4: …", "a, b, 3 each": a name and its bits, 1 where none are told.
Texts fields_told(const std::string& cell) {
  Texts fields;
  for (const std::string& item : parts_of(before(cell, ":"), ',')) {
    const bool is_for_all = item.ends_with(" each");
    if (is_for_all) {
      for (std::string& field : fields) field = before(field, " ") + " " + before(item, " ");
      continue;
    }
    for (const std::string& field : expanded(item)) {
      fields.push_back(field.find(' ') == std::string::npos ? field + " 1" : field);
    }
  }
  return fields;
}

Texts fields_of(const RegisterFacts& facts) {
  Texts fields;
  for (const Field& of : facts.fields) {
    fields.push_back(std::string(of.name) + " " + std::to_string(of.bits));
  }
  return fields;
}

// "a 2 1 16 0…": of a layer.
std::uint32_t told_by_layer(const std::string& list, std::size_t layer) {
  const Texts words = parts_of(list, ' ');
  if (layer + 1 >= words.size() || words[layer + 1].ends_with("…")) return 0;
  return static_cast<std::uint32_t>(std::stoul(words[layer + 1]));
}

// What a cell says that a field is by default; the whole register's number is told by bits.
std::uint32_t default_told(const std::string& cell, const RegisterFacts& facts, std::size_t field,
                           std::size_t layer) {
  const Field& of = facts.fields[field];
  if (cell == "–") return 0;
  if (cell == "the layer's number") return static_cast<std::uint32_t>(layer);
  if (cell == "n for bit n") return static_cast<std::uint32_t>(field);
  if (cell.starts_with("by layer: ")) {
    return told_by_layer(parts_of(cell.substr(cell.find(':') + 1), ';').at(field), layer);
  }
  const Texts numbers = parts_of(cell, ',');
  if (numbers.size() > 1) return static_cast<std::uint32_t>(std::stoul(numbers.at(field), {}, 0));
  const std::size_t blank = cell.find(' ');
  if (blank != std::string::npos) {
    const bool is_this = before(cell, " ") == of.name;
    return is_this ? static_cast<std::uint32_t>(std::stoul(cell.substr(blank))) : 0;
  }
  return static_cast<std::uint32_t>(std::stoul(cell, {}, 0) >> of.first_bit &
                                    ((1UL << of.bits) - 1));
}

bool has_defaults(const RegisterFacts& facts, const std::string& cell) {
  if (facts.bits == 0) return cell == "–";
  const RegisterWords words = default_words(facts.number);
  for (std::size_t field = 0; field < facts.fields.size(); ++field) {
    for (int layer = 0; layer < kLayers; ++layer) {
      const auto told = default_told(cell, facts, field, static_cast<std::size_t>(layer));
      if (words.get(facts.fields[field], layer) != told) return false;
    }
  }
  return true;
}

// Of a row, what is not as the register has it.
Texts mistakes_in(const Texts& row, const RegisterFacts& facts, const std::vector<Texts>& rows) {
  Texts mistakes;
  const auto expect = [&](bool is_so, const std::string& what) {
    if (!is_so) mistakes.push_back(std::string(facts.name) + ": " + what);
  };
  expect(row[0] == std::to_string(static_cast<int>(facts.number)), "number");
  expect(before(row[1], " (") == facts.name, "name");
  expect(row[2] == (facts.bits == 0 ? "port" : std::to_string(facts.bits)), "bits");
  const bool is_as_another = row[3].starts_with("as ");
  const std::string& fields = is_as_another ? rows.at(std::stoul(row[3].substr(3))).at(3) : row[3];
  expect(facts.bits == 0 || fields_told(fields) == fields_of(facts), "fields");
  expect(row[4] == (facts.waits ? "yes" : "no"), "wait");
  expect(has_defaults(facts, row[5]), "default");
  return mistakes;
}

Texts mistakes_in(const std::string& page) {
  const std::vector<Texts> rows = rows_of(page);
  if (rows.size() != kRegisters.size()) return {std::to_string(rows.size()) + " registers"};
  Texts mistakes;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Texts of_row = mistakes_in(rows[i], kRegisters[i], rows);
    mistakes.insert(mistakes.end(), of_row.begin(), of_row.end());
  }
  return mistakes;
}

TEST(CambusRegistersPage, TellsEachRegisterAsItIs) {
  EXPECT_THAT(mistakes_in(page_text()), testing::IsEmpty());
}

struct Slip {
  std::string text;
  std::string instead;
  std::string mistake;
};
class CambusRegistersPageSlip : public testing::TestWithParam<Slip> {};
INSTANTIATE_TEST_SUITE_P(
    Slips, CambusRegistersPageSlip,
    testing::Values(Slip{"| 2 | kick", "| 3 | kick", "kick: number"},
                    Slip{"| fly-src (", "| fly-source (", "fly-src: name"},
                    Slip{"| 30 | amount", "| 29 | amount", "kick: bits"},
                    Slip{"lut-io (LIOR) | port", "lut-io (LIOR) | 16", "lut-io: bits"},
                    Slip{"tree-delay 6", "tree-delay 5", "environment: fields"},
                    Slip{"sign-x, sign-y", "sign-y, sign-x", "kick: fields"},
                    Slip{"a0 to a23, 5", "a0 to a22, 5", "scan-perm: fields"},
                    Slip{"zm, zp, 3 each", "zm, zp, 4 each", "connect: fields"},
                    Slip{"as 26 | no", "as 26 | yes", "int-enable: wait"},
                    Slip{"| sync 3 |", "| sync 2 |", "run: default"},
                    Slip{"0x3e4", "0x3e5", "int-enable: default"},
                    Slip{"0, 31, 31, 31", "0, 31, 30, 31", "dimension: default"},
                    Slip{"| the layer's number |", "| 0 |", "lut-perm: default"},
                    Slip{"a 2 1 16 24", "a 2 1 24 16", "multi: default"},
                    Slip{"\n| 28 | dram-count", "\n28 | dram-count", "28 registers"}));

TEST_P(CambusRegistersPageSlip, IsNoticed) {
  std::string page = page_text();
  const std::size_t at = page.find(GetParam().text, page.find("## 2. Registers"));
  ASSERT_NE(at, std::string::npos);
  page.replace(at, GetParam().text.size(), GetParam().instead);
  EXPECT_THAT(mistakes_in(page), testing::ElementsAre(GetParam().mistake));
}

}  // namespace
}  // namespace thimble::cambus
