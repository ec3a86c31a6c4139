#include "sim/model/cam/cam_machine.hpp"

#include <gtest/gtest.h>

#include "tests/unit/cam/cam_bench.hpp"

// What registers do, on a machine that is spoken to word by word.
namespace thimble::cambus {
namespace {

using sim::cam::CamMachine;
using sim::cam::CamModule;
using test::CamBench;
using test::Cells;
using Words = std::vector<std::uint16_t>;

void send(CamMachine& machine, const RegisterWords& words) {
  machine.write(static_cast<std::uint32_t>(words.number()), words.words());
}
void send(CamMachine& machine, Register number, const Words& words) {
  machine.write(static_cast<std::uint32_t>(number), words);
}
Words ask(CamMachine& machine, Register number, std::uint32_t length) {
  return machine.read(static_cast<std::uint32_t>(number), length).value();
}
void select_all(CamMachine& machine) { send(machine, default_words(Register::Select)); }
std::uint32_t flags(const CamModule& module) {
  std::uint32_t bits = 0;
  for (std::size_t bit = 0; bit < 10; ++bit) {
    bits |= module.registers.planes(Register::IntFlags)[bit] != 0 ? 1U << bit : 0U;
  }
  return bits;
}

TEST(CamMachine, RegistersKeepWhatIsWritten) {
  std::mt19937 random(1);
  CamMachine sut({{1, 1, 1}, 6});
  select_all(sut);
  for (const RegisterFacts& facts : kRegisters) {
    if (facts.bits == 0 || facts.number == Register::Run) continue;
    if (facts.number == Register::Select || facts.number == Register::Verify) continue;
    if (facts.number == Register::Event) {
      send(sut, default_words(Register::ScanFormat));
    }
    Words words(facts.bits);
    for (auto& word : words) word = static_cast<std::uint16_t>(random());
    send(sut, facts.number, words);
    EXPECT_EQ(ask(sut, facts.number, facts.bits), words) << facts.name;
  }
  EXPECT_EQ(sut.counters().unmodelled, 3U);  // fly-src, environment, multi
}

TEST(CamMachine, WhatProgramsSetUpIsModelledAndIsNotCounted) {
  CamBench bench({{1, 1, 0}, {4, 4, 0}, Division::Mesh});
  EXPECT_EQ(bench.machine().counters().unmodelled, 0U);
  CamMachine& sut = bench.machine();
  const auto& environment = field::kEnvironment;
  send(sut, RegisterWords(Register::Environment).set(environment[6], 1).set(environment[7], 1));
  EXPECT_EQ(sut.counters().unmodelled, 0U);
  send(sut, RegisterWords(Register::Environment).set(environment[5], 1, 0x0100));
  EXPECT_EQ(sut.counters().unmodelled, 1U);
  send(sut, RegisterWords(Register::FlySrc).set(field::kSource<Register::FlySrc>[1], kMapOne));
  EXPECT_EQ(sut.counters().unmodelled, 2U);
  send(sut, default_words(Register::Multi));
  EXPECT_EQ(sut.counters().unmodelled, 3U);

  const auto& touches = sut.unmodelled_touches();
  ASSERT_EQ(touches.size(), 3U);
  EXPECT_EQ(touches[0].of, Register::Environment);
  EXPECT_EQ(touches[1].of, Register::FlySrc);
  EXPECT_EQ(touches[2].of, Register::Multi);
  EXPECT_LT(touches[0].at_clocks, touches[1].at_clocks);
}

TEST(CamMachine, OfWhatIsNotModelledTheFirstTouchesAreKeptAndAllAreCounted) {
  CamMachine sut({{1, 1, 1}, 6});
  select_all(sut);
  const std::uint64_t most = CamMachine::kMostTouches;
  for (std::uint64_t i = 0; i <= most; ++i) send(sut, default_words(Register::Multi));
  EXPECT_EQ(sut.counters().unmodelled, most + 1);
  EXPECT_EQ(sut.unmodelled_touches().size(), most);
}

TEST(CamMachine, AfterAResetOneModuleIsMarkedAndAllIsZero) {
  CamMachine sut({{2, 2, 1}, 6});
  select_all(sut);
  send(sut, RegisterWords(Register::SaBit).set(field::kSaBit[0], 9));
  send(sut, RegisterWords(Register::Offset).set(field::kOffset[0], 0x123));
  send(sut, RegisterWords(Register::DramCount).set(field::kDramCount[0], 7));
  sut.reset();
  for (std::size_t i = 0; i < 4; ++i) {
    const CamModule& module = sut.torus().modules[i];
    EXPECT_EQ(module.registers.get(field::kModuleId[0], 0), i == 0 ? 1U : 0U);
    EXPECT_EQ(module.registers.get(field::kSaBit[0], 0), 0U);
    EXPECT_EQ(module.registers.get(field::kOffset[0], 5), 0x123U);
    EXPECT_EQ(module.registers.get(field::kDramCount[0], 5), 7U);
  }
}

TEST(CamMachine, NobodyAnswersWhereNobodyIsSelected) {
  CamMachine sut({{1, 1, 1}, 6});
  send(sut, RegisterWords(Register::Select).set(field::kSelect[1], 1));  // id 0xffff
  EXPECT_FALSE(sut.read(static_cast<std::uint32_t>(Register::Offset), 24));
}

TEST(CamMachine, AGroupIsSelectedByItsId) {
  CamBench bench({{1, 1, 0}, {3, 3, 0}, Division::Mesh});
  CamMachine& sut = bench.machine();
  const auto select_modules = [&](std::uint32_t low_bit) {  // bit 0 of the id, the rest whatever
    send(sut, default_words(Register::Select)
                  .set(field::kSelect[0], 0, 1)
                  .set(field::kSelect[1], low_bit, 1));
  };
  select_modules(1);
  send(sut, RegisterWords(Register::GroupId).set(field::kGroupId[0], 1));
  select_all(sut);
  send(sut, RegisterWords(Register::Select).set(field::kSelect[0], 1).set(field::kSelect[1], 1));
  send(sut, RegisterWords(Register::SaBit).set(field::kSaBit[0], 5));
  select_all(sut);
  std::size_t changed = 0;
  for (const CamModule& module : sut.torus().modules) {
    const bool is_odd = module.registers.get(field::kModuleId[0], 0) != 0;
    EXPECT_EQ(module.registers.get(field::kSaBit[0], 0), is_odd ? 5U : 0U);
    changed += is_odd ? 1 : 0;
  }
  EXPECT_EQ(changed, 2U);
}

TEST(CamMachine, TheInactiveTableIsLoadedAndSwapped) {
  std::mt19937 random(2);
  CamMachine sut({{1, 1, 1}, 6});
  select_all(sut);
  send(sut, default_words(Register::LutPerm));
  const Words table = test::random_cells(kTableEntries, 0xffff, random);
  send(sut, Register::LutIo, table);
  EXPECT_NE(sut.torus().modules[0].active_table(), table);
  EXPECT_EQ(ask(sut, Register::LutIo, kTableEntries), table);
  send(sut, RegisterWords(Register::Run).set(field::kNewTable, 1));
  EXPECT_EQ(sut.torus().modules[0].active_table(), table);
  send(sut, Register::LutIo, Words(kTableEntries, 3));
  EXPECT_EQ(sut.torus().modules[0].active_table(), table);
  EXPECT_EQ(flags(sut.torus().modules[0]), 0U);
}

TEST(CamMachine, APartOfATableIsLoadedByConstantsInItsIndex) {
  CamMachine sut({{1, 1, 1}, 6});
  select_all(sut);
  // Entries 0xa0 to 0xaf: four bits count, the others are constants.
  RegisterWords perm = default_words(Register::LutPerm);
  perm.set(field::kLutPerm[0], kConstant0, 0xfff0).set(field::kLutPerm[0], kConstant1, 0x00a0);
  send(sut, perm);
  send(sut, RegisterWords(Register::LutIndex).set(field::kLutIndex[0], 0xfff0));
  send(sut, Register::LutIo, Words(16, 0x1234));
  const auto& table = sut.torus().modules[0].tables[1];
  for (std::size_t n = 0; n < table.size(); ++n) {
    ASSERT_EQ(table[n], n >= 0xa0 && n < 0xb0 ? 0x1234 : 0) << n;
  }
  send(sut, RegisterWords(Register::LutIndex).set(field::kLutIndex[0], 0xffff));
  send(sut, Register::LutIo, Words(2));
  EXPECT_EQ(flags(sut.torus().modules[0]), 1U << 7);
}

TEST(CamMachine, LayersThatVerifyAreNotWritten) {
  CamMachine sut({{1, 1, 1}, 6});
  select_all(sut);
  send(sut, RegisterWords(Register::SaBit).set(field::kSaBit[0], 3));
  send(sut, RegisterWords(Register::Verify).set(field::kVerify[0], 1, 0x00ff));
  send(sut, RegisterWords(Register::SaBit)
                .set(field::kSaBit[0], 3, 0xff0f)
                .set(field::kSaBit[0], 7, 0x00f0));
  const CamModule& module = sut.torus().modules[0];
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    EXPECT_EQ(module.registers.get(field::kSaBit[0], layer), 3U);
    const bool has_differed = layer >= 4 && layer < 8;
    EXPECT_EQ(module.registers.get(field::kVerify[2], layer), has_differed ? 1U : 0U) << layer;
  }
  send(sut, RegisterWords(Register::Verify));
  send(sut, RegisterWords(Register::SaBit).set(field::kSaBit[0], 9));
  EXPECT_EQ(module.registers.get(field::kSaBit[0], 0), 9U);
}

TEST(CamMachine, LayersThatVerifyAreNotKicked) {
  CamMachine sut({{1, 1, 1}, 6});
  select_all(sut);
  const CamModule& module = sut.torus().modules[0];
  const auto expect_offsets = [&](std::uint32_t low, std::uint32_t high, const char* after) {
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      const std::uint32_t offset = module.registers.get(field::kOffset[0], layer);
      EXPECT_EQ(offset, layer < 8 ? low : high) << after << ", layer " << layer;
    }
  };
  send(sut, RegisterWords(Register::Kick).set(field::kKickAmount, 1));
  send(sut, RegisterWords(Register::Offset).set(field::kOffset[0], 100));
  send(sut, RegisterWords(Register::Verify).set(field::kVerify[0], 1, 0x00ff));
  send(sut, RegisterWords(Register::Kick).set(field::kKickAmount, 3));
  expect_offsets(100, 97, "kick");
  const auto repeat = RegisterWords(Register::Run).set(field::kRepeatKick, 1);
  send(sut, repeat);
  expect_offsets(100, 94, "repeat");
  send(sut, RegisterWords(Register::Verify));
  send(sut, repeat);
  expect_offsets(99, 91, "repeat of all");
}

TEST(CamMachine, LayersThatVerifyKeepTheirCounts) {
  CamMachine sut({{1, 1, 1}, 6});
  select_all(sut);
  send(sut, default_words(Register::ScanFormat));
  CamModule& module = sut.torus().modules[0];
  module.event_counters.fill(5);
  send(sut, RegisterWords(Register::Verify).set(field::kVerify[0], 1, 0x00ff));
  send(sut, RegisterWords(Register::Event).set(field::kEvent[0], 7));
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    EXPECT_EQ(module.event_counters[layer], layer < 8 ? 5U : 7U) << layer;
    EXPECT_EQ(module.registers.get(field::kEvent[0], layer), layer < 8 ? 0U : 7U) << layer;
  }
  send(sut, RegisterWords(Register::Run).set(field::kNewCount, 1));
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    EXPECT_EQ(module.event_counters[layer], layer < 8 ? 5U : 0U) << layer;
    EXPECT_EQ(module.registers.get(field::kEvent[0], layer), layer < 8 ? 0U : 7U) << layer;
  }
}

TEST(CamMachine, WrongLengthsAndUnknownRegistersAreFlaggedAndInterruptWhereEnabled) {
  CamMachine sut({{1, 1, 1}, 6});
  select_all(sut);
  send(sut, Register::SaBit, Words(4));
  EXPECT_EQ(flags(sut.torus().modules[0]), 1U << 7);
  sut.write(30, Words(1));
  EXPECT_EQ(flags(sut.torus().modules[0]), 1U << 7 | 1U << 8);
  EXPECT_EQ(sut.read(31, 2).value(), Words(2));
  EXPECT_FALSE(sut.has_interrupt());
  send(sut, default_words(Register::IntEnable));
  EXPECT_TRUE(sut.has_interrupt());
  send(sut, RegisterWords(Register::IntFlags));
  EXPECT_FALSE(sut.has_interrupt());
}

// A scan in parts, each with the kick undone and sent again, is a scan in one.
TEST(CamMachine, SubScansMakeTheSameAsOne) {
  std::mt19937 random(7);
  const test::Layout layout{{1, 1, 0}, {4, 4, 0}, Division::Mesh};
  const std::vector<LayerKick> kicks{{0x00f0, {3, -2, 0}}, {0x0f00, {-8, 1, 0}}};
  const std::vector<LayerKick> undone{{0x00f0, {-3, 2, 0}}, {0x0f00, {8, -1, 0}}};
  const auto rule = [](std::uint32_t cell) { return cell * 40503U; };
  CamBench whole(layout);
  CamBench parts(layout);
  const Cells cells = test::random_cells(whole.cell_count(), 0xffff, random);
  for (CamBench* bench : {&whole, &parts}) {
    bench->load(rule);
    bench->put(cells);
  }
  whole.step(kicks);
  StepListBuilder list;
  RegisterWords format = parts.space().scan_format(parts.space().whole());
  list.write(format.set(field::kEndOfScan, 4));
  for (int part = 0; part < 4; ++part) {
    if (part > 0) list.write(parts.space().kick(undone).value());
    list.write(parts.space().kick(kicks).value());
    list.write(default_words(Register::Run));
  }
  list.write(parts.space().scan_format(parts.space().whole()));
  parts.play(list.finish());
  EXPECT_EQ(parts.get(), whole.get());
}

// docs/cambus.md, scan-io: the scan is as long as the transfer.
TEST(CamMachine, AScanAtThePaceOfTheHostEndsWithItsTransfer) {
  for (const auto scanning : {sim::cam::Scanning::SiteBySite, sim::cam::Scanning::Fast}) {
    CamMachine sut({{1, 1, 1}, 8}, scanning);
    select_all(sut);
    send(sut, default_words(Register::ScanPerm));
    send(sut, default_words(Register::ScanFormat).set(field::kEndOfScan, 8));
    send(sut, RegisterWords(Register::SiteSrc)
                  .set(field::kSource<Register::SiteSrc>[0], kSelectHost)
                  .set(field::kSource<Register::SiteSrc>[1], kMapSource));
    std::uint32_t written = 0;
    for (const std::uint32_t length : {64U, 1U, 63U, 128U, 256U}) {
      send(sut, Register::ScanIo, Words(length, static_cast<std::uint16_t>(length)));
      written += length;
      EXPECT_FALSE(sut.is_scanning());
      EXPECT_FALSE(sut.hangs());
      const auto before = sut.now_clocks();
      sut.wait_for_scan();
      EXPECT_EQ(sut.now_clocks(), before);
      EXPECT_EQ(sut.torus().modules[0].registers.get(field::kScanIndex[0], 5), written);
      EXPECT_EQ(sut.torus().modules[0].dram[(written - 1) % 256], length);
    }
  }
}

TEST(CamMachine, TheOrderOfTheScanChangesNothing) {
  std::mt19937 random(8);
  const test::Layout layout{{1, 1, 0}, {4, 4, 0}, Division::StripX};
  const std::vector<LayerKick> kicks{{0x00ff, {1, 5, 0}}, {0xff00, {-2, -1, 0}}};
  const auto rule = [](std::uint32_t cell) { return (cell * 40503U) ^ (cell >> 3); };
  CamBench straight(layout);
  const Cells cells = test::random_cells(straight.cell_count(), 0xffff, random);
  straight.load(rule);
  straight.put(cells);
  straight.step(kicks, 3);
  const Cells expected = straight.get();
  for (int i = 0; i < 3; ++i) {
    CamBench shuffled(layout);
    shuffled.load(rule);
    shuffled.put(cells);
    std::vector<std::uint32_t> order(
        static_cast<std::size_t>(shuffled.space().log2_sector_sites()));
    for (std::uint32_t bit = 0; bit < order.size(); ++bit) order[bit] = bit;
    std::shuffle(order.begin(), order.end(), random);
    StepListBuilder list;
    RegisterWords perm = shuffled.space().scan_perm(shuffled.space().whole());
    for (std::size_t bit = 0; bit < order.size(); ++bit)
      perm.set(field::kScanPerm[bit], order[bit]);
    list.write(perm);
    shuffled.play(list.finish());
    shuffled.step(kicks, 3);
    StepListBuilder back;
    back.write(shuffled.space().scan_perm(shuffled.space().whole()));
    shuffled.play(back.finish());
    EXPECT_EQ(shuffled.get(), expected);
  }
}

TEST(CamMachine, TheOnesInTheDramAreCountedAsTheyCome) {
  std::mt19937 random(9);
  CamBench bench({{0, 0, 0}, {3, 3, 0}, Division::Mesh});
  for (int i = 0; i < 3; ++i) {
    const Cells cells = test::random_cells(bench.cell_count(), 0xffff, random);
    bench.put(cells);
    const CamModule& module = bench.machine().torus().modules[0];
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      std::array<std::uint32_t, 2> ones{};
      for (std::size_t n = 0; n < cells.size(); ++n) ones[n / 32] += (cells[n] >> layer) & 1U;
      EXPECT_EQ(module.registers.get(field::kDramCount[0], layer), ones[0]);
      EXPECT_EQ(module.registers.get(field::kDramCount[1], layer), ones[1]);
    }
  }
}

}  // namespace
}  // namespace thimble::cambus
