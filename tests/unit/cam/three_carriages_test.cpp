#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <random>

#include "drivers/cambus/cam_program.hpp"
#include "drivers/cambus/list_player.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "tests/support/usb_cam_board.hpp"
#include "tests/unit/cambus/hand_list.hpp"

// The same step lists, given to a machine itself, over PCI and over USB, read the same words and
// leave the same machine.
namespace thimble::cambus {
namespace {

using Words = std::vector<std::uint16_t>;

const BoardShape kShape{{1, 1, 0}, 6};
const sim::cam::BoardOptions kBoard{.shape = {{2, 2, 1}, 6},
                                    .window_bytes = std::size_t{1} << 20,
                                    .is_paced = false,
                                    .scanning = sim::cam::Scanning::SiteBySite};

struct RandomList {
  StepList list;
  std::vector<ReadSlot> slots;
};

class ListMaker {
 public:
  explicit ListMaker(unsigned seed) : random_(seed) {}

  RandomList first() {
    program_.number_modules();
    program_.set_up();
    program_.load_table(words(kTableEntries));
    program_.run({.is_scan = false, .takes_counts = true, .swaps_tables = true});
    program_.load_table(words(kTableEntries));
    for (int module = 0; module < 4; ++module) program_.write_sites(module, words(64));
    return {program_.finish(), {}};
  }
  RandomList next() {
    RandomList made;
    for (unsigned n = 1 + below(8); n > 0; --n) add(made.slots);
    for (int module = 0; module < 4; ++module) made.slots.push_back(program_.read_sites(module));
    made.list = program_.finish();
    return made;
  }

 private:
  unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }
  Words words(std::size_t count) {
    Words made(count);
    for (auto& word : made) word = static_cast<std::uint16_t>(random_());
    return made;
  }
  int few() { return static_cast<int>(below(5)) - 2; }
  void add(std::vector<ReadSlot>& slots) {
    switch (below(12)) {
      case 0:
        return program_.load_table(words(kTableEntries));
      case 1:
        return program_.fix(static_cast<LayerMask>(random_()), words(1)[0]);
      case 2:
        return program_.count(static_cast<CamProgram::Events>(below(3)));
      case 3:
        return program_.write_sites(static_cast<int>(below(4)), words(64));
      case 4:
        return program_.delay(1 + below(5000));
      case 5:
      case 6: {
        const auto counts = program_.read_counts();
        slots.insert(slots.end(), counts.begin(), counts.end());
        return;
      }
      case 7:
        return program_.run(
            {.is_scan = false, .takes_counts = true, .swaps_tables = below(2) == 0});
      default: {
        const LayerKick kick{static_cast<LayerMask>(random_()), {few(), few(), few()}};
        EXPECT_TRUE(program_.kick({&kick, 1}));
        return program_.run({.takes_counts = below(2) == 0, .swaps_tables = below(4) == 0});
      }
    }
  }

  std::mt19937 random_;
  CamProgram program_{CamSpace::make(kShape, {3, 3, 2}, Division::Mesh).value()};
};

// One way to a machine.
class Carriage {
 public:
  virtual ~Carriage() = default;
  virtual void play(const StepList& list) = 0;
  virtual Words words_of(const ReadSlot& slot) = 0;
  virtual sim::cam::CamCounters counters() = 0;
};

class Direct final : public Carriage {
 public:
  void play(const StepList& list) override {
    window_ = test::HandWindow(list.base + list.bytes.size());
    std::copy(list.bytes.begin(), list.bytes.end(), window_.bytes().begin() + list.base);
    sim::cam::StepInterface interface(machine_, bus::SharedWords(window_.words()));
    interface.write_next_list(list.head);
    ASSERT_TRUE(interface.run(100'000));
  }
  Words words_of(const ReadSlot& slot) override {
    Words words(slot.words);
    for (std::uint32_t k = 0; k < slot.words; ++k) {
      words[k] = buffer_word({0, window_.bytes()}, slot.offset, k);
    }
    return words;
  }
  sim::cam::CamCounters counters() override { return machine_.counters(); }

 private:
  sim::cam::CamMachine machine_{kBoard.shape};
  test::HandWindow window_{0};
};

class Carried : public Carriage {
 public:
  void play(const StepList& list) override {
    ASSERT_TRUE(player_->start(list, std::chrono::seconds(5), clock_.now()));
    auto is_over = player_->poll(clock_.now());
    while (is_over && !*is_over) {
      clock_.run_for(std::chrono::microseconds(125));
      is_over = player_->poll(clock_.now());
    }
    ASSERT_TRUE(is_over) << is_over.error().message;
  }
  Words words_of(const ReadSlot& slot) override {
    while (true) {
      auto words = player_->words_of(slot, clock_.now());
      if (words) return *std::move(words);
      EXPECT_EQ(words.error().code, Errc::Busy) << words.error().message;
      if (words.error().code != Errc::Busy) return {};
      clock_.run_for(std::chrono::microseconds(125));
      EXPECT_TRUE(player_->poll(clock_.now()));  // another turn
      static_cast<void>(port_->poll(clock_.now(), status_));
    }
  }

 protected:
  void open(std::unique_ptr<BoardPort> port) {
    port_ = std::move(port);
    player_.emplace(*port_, ListLimits{.module_sites = 64});
  }
  // Before what it goes to.
  void close() {
    player_.reset();
    port_.reset();
  }
  sim::VirtualClock clock_;

 private:
  std::unique_ptr<BoardPort> port_;
  std::optional<ListPlayer> player_;
  BoardStatus status_;
};

class OverPci final : public Carried {
 public:
  ~OverPci() override { close(); }
  OverPci() { open(PciPort::open(slot_.open_window(), clock_.now()).value()); }
  sim::cam::CamCounters counters() override { return slot_.board().machine().counters(); }

 private:
  sim::cam::SimCamBoard slot_{clock_, kBoard};
};

class OverUsb final : public Carried {
 public:
  ~OverUsb() override { close(); }
  OverUsb() { open(thimble::test::open_usb_port(plug_, clock_)); }
  sim::cam::CamCounters counters() override { return plug_.model().board().machine().counters(); }

 private:
  sim::cam::SimUsbCamBoard plug_{clock_, kBoard};
};

TEST(ThreeCarriages, TheSameListsReadTheSameWordsAndCountTheSame) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    ListMaker maker(seed);
    Direct direct;
    OverPci pci;
    OverUsb usb;
    const std::array<Carriage*, 3> all{&direct, &pci, &usb};
    RandomList made = maker.first();
    for (int i = 0; i < 12; ++i) {
      for (Carriage* way : all) ASSERT_NO_FATAL_FAILURE(way->play(made.list)) << seed << ' ' << i;
      for (const ReadSlot& slot : made.slots) {
        const Words words = direct.words_of(slot);
        ASSERT_EQ(pci.words_of(slot), words) << seed << ' ' << i;
        ASSERT_EQ(usb.words_of(slot), words) << seed << ' ' << i;
      }
      made = maker.next();
    }
    EXPECT_GT(direct.counters().scans, 10U);
    EXPECT_EQ(pci.counters(), direct.counters());
    EXPECT_EQ(usb.counters(), direct.counters());
  }
}

}  // namespace
}  // namespace thimble::cambus
