#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "drivers/cambus/register_words.hpp"
#include "tests/unit/cam/cam_bench.hpp"

// A machine that moves bits many sites at a time beside one that moves them site by site: the same
// frames to both, and then everything that can be seen of them is the same.
namespace thimble::sim::cam {
namespace {

using cambus::CamProgram;
using cambus::Division;
using cambus::Register;
using cambus::RegisterWords;
using cambus::test::Layout;
namespace field = cambus::field;

class Random {
 public:
  using result_type = std::uint32_t;
  explicit Random(unsigned seed) : engine_(seed) {}
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return 0xffffffff; }
  result_type operator()() { return static_cast<result_type>(engine_()); }

 private:
  std::mt19937 engine_;
};
using Table = std::vector<std::uint16_t>;

bool one_in(Random& random, unsigned n) { return random() % n == 0; }

Table any_table(Random& random) {
  Table table(cambus::kTableEntries);
  for (auto& entry : table) entry = static_cast<std::uint16_t>(random());
  return table;
}

// Of a few inputs, most layers kept: what compiles.
Table small_table(Random& random) {
  const unsigned a = random() % 16;
  const unsigned b = random() % 16;
  const unsigned to = random() % 16;
  const unsigned other = random() % 16;
  Table table(cambus::kTableEntries);
  for (unsigned n = 0; n < table.size(); ++n) {
    const unsigned both = n >> a & n >> b & 1U;
    table[n] = static_cast<std::uint16_t>((n & ~(1U << to)) | both << to);
    table[n] = static_cast<std::uint16_t>(table[n] ^ (n >> b & 1U) << other);
  }
  return table;
}

class BothMachines {
 public:
  explicit BothMachines(const TorusShape& shape) : plain(shape), fast(shape, Scanning::Fast) {
    for (CamMachine* machine : {&plain, &fast}) machine->set_sync({547, 247, kLines, 3});
  }

  void write(const RegisterWords& words) {
    write(static_cast<std::uint32_t>(words.number()), words.words());
  }
  void write(std::uint32_t number, std::span<const std::uint16_t> words) {
    plain.wait_for_scan();
    fast.wait_for_scan();
    plain.write(number, words);
    fast.write(number, words);
  }
  void load(const Table& table) {
    write(cambus::default_words(Register::LutIndex));
    write(static_cast<std::uint32_t>(Register::LutIo), table);
  }
  // By its number, once modules are numbered; all for none.
  void select(std::optional<std::size_t> module) {
    if (!module) return write(cambus::default_words(Register::Select));
    write(RegisterWords(Register::Select)
              .set(field::kSelect[1], cambus::kTargetOne, static_cast<std::uint16_t>(*module)));
  }
  void number_modules() {
    for (CamMachine* machine : {&plain, &fast}) {
      auto& modules = machine->torus().modules;
      for (std::size_t i = 0; i < modules.size(); ++i) {
        modules[i].registers.planes(Register::ModuleId)[0] = static_cast<std::uint16_t>(i);
      }
    }
  }
  void fill(Random& random) {
    for (auto& module : plain.torus().modules) {
      for (auto& site : module.dram) site = static_cast<std::uint16_t>(random());
    }
    for (std::size_t i = 0; i < plain.torus().size(); ++i) {
      fast.torus().modules[i].dram = plain.torus().modules[i].dram;
    }
  }
  void expect_same() {
    ASSERT_EQ(plain.now_clocks(), fast.now_clocks());
    ASSERT_EQ(plain.is_scanning(), fast.is_scanning());
    ASSERT_EQ(plain.has_interrupt(), fast.has_interrupt());
    ASSERT_EQ(plain.counters().scans, fast.counters().scans);
    ASSERT_EQ(plain.counters().disturbed_scans, fast.counters().disturbed_scans);
    ASSERT_EQ(plain.monitor().frames(), fast.monitor().frames());
    for (std::size_t line = 0; line < kLines; ++line) {
      const auto a = plain.monitor().line(line);
      const auto b = fast.monitor().line(line);
      ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << line;
    }
    for (std::size_t i = 0; i < plain.torus().size(); ++i) {
      const CamModule& a = plain.torus().modules[i];
      const CamModule& b = fast.torus().modules[i];
      ASSERT_EQ(a.event_counters, b.event_counters) << i;
      ASSERT_TRUE(a.dram == b.dram) << i;
      ASSERT_TRUE(a.tables == b.tables) << i;
      for (std::size_t number = 0; number < cambus::kRegisterCount; ++number) {
        const auto of = static_cast<Register>(number);
        ASSERT_EQ(a.registers.planes(of), b.registers.planes(of)) << number << " of " << i;
      }
    }
  }

  static constexpr std::uint32_t kLines = 40;
  CamMachine plain, fast;
  std::uint64_t free_scans{0};
  std::uint64_t scans_in_words{0};  // of those
  std::uint64_t lines_in_words{0};  // of the others
  std::uint64_t parts_in_words{0};  // of free scans, those of a part of the space
};

class WildRegisters {
 public:
  WildRegisters(Random& random, int log2_sites) : random_(random), log2_sites_(log2_sites) {}

  // In each layer anything, or the same in all.
  RegisterWords anything(Register of) {
    RegisterWords words(of);
    const bool is_uniform = one_in(random_, 2);
    for (auto& word : words.words()) {
      word = is_uniform ? (one_in(random_, 2) ? 0xffff : 0) : static_cast<std::uint16_t>(random_());
    }
    return words;
  }
  RegisterWords source(Register of, const std::array<cambus::Field, 2>& fields) {
    RegisterWords words = anything(of);
    constexpr std::array kUsual{cambus::kMapZero, cambus::kMapSite, cambus::kMapSource,
                                cambus::kMapOne};
    for (int layer = 0; layer < 16; ++layer) {
      if (one_in(random_, 2)) words.set(fields[1], kUsual[random_() % 4], bit(layer));
      if (one_in(random_, 2)) words.set(fields[0], 3, bit(layer));
    }
    return words;
  }
  RegisterWords dimension() {
    RegisterWords words(Register::Dimension);
    const bool is_uniform = !one_in(random_, 4);
    for (int layer = 0; layer < (is_uniform ? 1 : 16); ++layer) {
      const std::uint16_t layers = is_uniform ? std::uint16_t{0xffff} : bit(layer);
      std::uint32_t cuts = random_() & random_();
      if (one_in(random_, 2)) cuts &= ~0x3fU;
      words.set(field::kCuts, cuts, layers);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        words.set(field::kDimension[1 + axis], one_in(random_, 3) ? 31 : random_() % 32, layers);
      }
    }
    return words;
  }
  RegisterWords kick() {
    RegisterWords words = anything(Register::Kick);
    const auto some = static_cast<std::uint16_t>(random_());
    for (auto& word : words.words()) word = static_cast<std::uint16_t>(word & some);
    return words;
  }
  // An aligned part of the space: the other bits are constants. The bits within a word go through
  // it fastest, whichever way round.
  RegisterWords part() {
    RegisterWords words(Register::ScanPerm);
    std::vector<std::size_t> in_word;
    std::vector<std::size_t> beyond;
    for (std::size_t bit = 0; bit < 24; ++bit) {
      const bool is_varying = bit < static_cast<std::size_t>(log2_sites_) && one_in(random_, 2);
      words.set(field::kScanPerm[bit],
                one_in(random_, 2) ? cambus::kConstant0 : cambus::kConstant1);
      if (is_varying) (bit < 6 ? in_word : beyond).push_back(bit);
    }
    if (one_in(random_, 2)) std::shuffle(in_word.begin(), in_word.end(), random_);
    if (one_in(random_, 2)) std::shuffle(beyond.begin(), beyond.end(), random_);
    std::uint32_t index_bit = 0;
    for (const auto bit : in_word) words.set(field::kScanPerm[bit], index_bit++);
    for (const auto bit : beyond) words.set(field::kScanPerm[bit], index_bit++);
    if (one_in(random_, 12)) words.set(field::kScanPerm[2], cambus::kConstant1, bit(3));
    part_bits_ = index_bit;
    return words;
  }
  // Now and then what only the reference can.
  RegisterWords permuter() {
    part_bits_ = 0;
    if (one_in(random_, 2)) return part();
    std::array<std::uint32_t, 24> codes{};
    for (std::uint32_t code = 0; code < 24; ++code) codes[code] = code;
    if (one_in(random_, 2)) {
      std::shuffle(codes.begin() + 6, codes.begin() + log2_sites_, random_);
    }
    for (std::size_t i = static_cast<std::size_t>(log2_sites_); i < 24; ++i) {
      codes[i] = 24 + random_() % 8;
    }
    if (one_in(random_, 12)) codes[6 + random_() % 18] = random_() % 32;
    if (one_in(random_, 10)) std::shuffle(codes.begin(), codes.end(), random_);
    RegisterWords words(Register::ScanPerm);
    for (std::size_t i = 0; i < 24; ++i) words.set(field::kScanPerm[i], codes[i]);
    if (one_in(random_, 12)) words.set(field::kScanPerm[8], cambus::kConstant1, bit(3));
    return words;
  }
  RegisterWords index() {
    RegisterWords words(Register::ScanIndex);
    const std::uint32_t aligned = one_in(random_, 10) ? 0 : 0x3f;
    const std::uint32_t part = random_() << (6 + random_() % 18) & ~aligned;
    words.set(field::kScanIndex[0], one_in(random_, 2) ? 0 : part);
    if (one_in(random_, 10)) words.set(field::kScanIndex[0], random_() & ~aligned, bit(5));
    return words;
  }
  RegisterWords format() {
    RegisterWords words = anything(Register::ScanFormat);
    const auto most = static_cast<unsigned>(log2_sites_);
    words.set(field::kEndOfScan,
              one_in(random_, 10) ? random_() % (most + 1) : 6 + random_() % (most - 5));
    if (part_bits_ > 0 && !one_in(random_, 6)) words.set(field::kEndOfScan, part_bits_);
    return words.set(field::kEventLength, cambus::kEventBits);
  }

  [[nodiscard]] bool is_part() const { return part_bits_ > 0; }

 private:
  static std::uint16_t bit(int layer) { return static_cast<std::uint16_t>(1U << layer); }
  Random& random_;
  int log2_sites_;
  std::uint32_t part_bits_{0};  // of the permuter written last; 0: it was no part
};

void write_wildly(BothMachines& sut, WildRegisters& wild, Random& random) {
  using R = Register;
  if (one_in(random, 2)) sut.write(wild.dimension());
  if (one_in(random, 2)) sut.write(wild.permuter());
  sut.write(wild.index());
  if (one_in(random, 2)) sut.write(wild.anything(R::Offset));
  if (one_in(random, 4)) sut.write(wild.anything(R::Connect));
  if (one_in(random, 4)) sut.write(wild.anything(R::SaBit));
  if (one_in(random, 2)) sut.write(wild.anything(R::ShowScan));
  if (one_in(random, 2)) sut.write(wild.source(R::LutSrc, field::kSource<R::LutSrc>));
  if (one_in(random, 2)) sut.write(wild.source(R::SiteSrc, field::kSource<R::SiteSrc>));
  if (one_in(random, 2)) sut.write(wild.source(R::EventSrc, field::kSource<R::EventSrc>));
  if (one_in(random, 2)) sut.write(wild.source(R::Display, field::kSource<R::Display>));
  if (one_in(random, 2)) sut.load(one_in(random, 2) ? any_table(random) : small_table(random));
}

void run(BothMachines& sut, WildRegisters& wild, Random& random, int log2_sites) {
  sut.write(wild.format());
  sut.write(wild.kick());
  const CamCounters before = sut.fast.counters();
  const std::uint32_t sync = !one_in(random, 4)  ? cambus::kSyncFree
                             : one_in(random, 2) ? cambus::kSyncLine
                                                 : cambus::kSyncFrame;
  sut.write(RegisterWords(Register::Run)
                .set(field::kSync, sync)
                .set(field::kNewCount, random() % 2)
                .set(field::kRepeatKick, random() % 2)
                .set(field::kNewTable, random() % 2));
  const bool is_in_words = sut.fast.counters().site_by_site == before.site_by_site;
  if (sync != cambus::kSyncFree) {
    if (is_in_words) ++sut.lines_in_words;
  } else {
    ++sut.free_scans;
    if (is_in_words) ++sut.scans_in_words;
    if (is_in_words && wild.is_part()) ++sut.parts_in_words;
  }
  if (!one_in(random, 3)) return;
  std::vector<std::uint16_t> told(std::size_t{1}
                                  << (6 + random() % (static_cast<unsigned>(log2_sites) - 5)));
  for (auto& word : told) word = static_cast<std::uint16_t>(random());
  sut.write(wild.index());
  sut.write(static_cast<std::uint32_t>(Register::ScanIo), told);
  sut.plain.wait_for_scan();
  sut.fast.wait_for_scan();
  const auto length = static_cast<std::uint32_t>(told.size());
  ASSERT_EQ(sut.plain.read(static_cast<std::uint32_t>(Register::ScanIo), length),
            sut.fast.read(static_cast<std::uint32_t>(Register::ScanIo), length));
}

std::string name_of(const testing::TestParamInfo<TorusShape>& shape) {
  return std::to_string(shape.param.size()) + "ModulesOf2ToThe" +
         std::to_string(shape.param.log2_sites);
}

class WildPrograms : public testing::TestWithParam<TorusShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, WildPrograms,
                         testing::Values(TorusShape{{1, 1, 1}, 7}, TorusShape{{1, 1, 1}, 13},
                                         TorusShape{{2, 1, 1}, 9}, TorusShape{{2, 2, 1}, 12},
                                         TorusShape{{1, 4, 1}, 10}, TorusShape{{2, 2, 2}, 10},
                                         TorusShape{{4, 4, 4}, 7}),
                         name_of);

TEST_P(WildPrograms, AreTheSameSiteBySiteAndInWords) {
  const int log2_sites = GetParam().log2_sites;
  std::uint64_t scans = 0;
  std::uint64_t in_words = 0;
  std::uint64_t parts = 0;
  std::uint64_t lines = 0;
  std::uint64_t drawn = 0;
  // Of many modules fewer: their tables take the time.
  const unsigned seeds = GetParam().size() > 8 ? 2 : 5;
  for (unsigned seed = 0; seed < seeds; ++seed) {
    Random random(seed);
    BothMachines sut(GetParam());
    WildRegisters wild(random, log2_sites);
    sut.number_modules();
    sut.select(std::nullopt);
    sut.fill(random);
    for (int i = 0; i < 12; ++i) {
      for (std::size_t module = 0; module < GetParam().size(); ++module) {
        sut.select(module);
        if (one_in(random, 12)) write_wildly(sut, wild, random);
      }
      if (!one_in(random, 4)) sut.select(std::nullopt);
      write_wildly(sut, wild, random);
      ASSERT_NO_FATAL_FAILURE(run(sut, wild, random, log2_sites));
      ASSERT_NO_FATAL_FAILURE(sut.expect_same()) << "seed " << seed << ", program " << i;
    }
    scans += sut.free_scans;
    in_words += sut.scans_in_words;
    parts += sut.parts_in_words;
    lines += sut.lines_in_words;
    drawn += sut.fast.monitor().frames();
  }
  EXPECT_GT(in_words, scans / 3);
  EXPECT_GT(parts, scans / 8);
  EXPECT_GT(lines, 0U);
  EXPECT_GT(drawn, 0U);
  EXPECT_LT(in_words, scans);
}

TEST(PlaneScan, AScanThatVisitsASiteTwiceIsLeftToTheReferenceAndCounted) {
  BothMachines sut(TorusShape{{1, 1, 1}, 8});
  Random random(3);
  sut.fill(random);
  sut.select(std::nullopt);
  sut.load(any_table(random));
  sut.write(cambus::default_words(Register::ScanPerm).set(field::kScanPerm[7], 30));
  sut.write(cambus::default_words(Register::ScanFormat).set(field::kEndOfScan, 8));
  sut.write(RegisterWords(Register::Run).set(field::kSync, cambus::kSyncFree));
  ASSERT_NO_FATAL_FAILURE(sut.expect_same());
  EXPECT_EQ(sut.fast.counters().site_by_site, 1U);
  EXPECT_EQ(sut.plain.counters().site_by_site, 0U);
}

}  // namespace
}  // namespace thimble::sim::cam
