#include "board/board_bar.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <memory>
#include <random>
#include <thread>

#include "drivers/cambus/cambus_page_wire.hpp"
#include "hal/linux/board_window.hpp"
#include "hal/linux/mapped_window.hpp"
#include "hal/linux/passed_descriptors.hpp"

namespace thimble::board {
namespace {

using linux::Descriptor;

TEST(PciBar, IsASlotAsSysfsCallsItAndADigit) {
  const auto sut = parse_bar("0000:0a:1f.7", "5");
  ASSERT_TRUE(sut);
  EXPECT_EQ(*sut, (PciBar{"0000:0a:1f.7", 5}));
}

TEST(PciBar, NothingElseIsOne) {
  for (const char* slot : {"", "0000:00:10.0 ", "00:10.0", "0000:00:10.0/..", "0000:00:1A.0",
                           "../../../etc:00.0", "0000-00:10.0", "0000:00:10:0"}) {
    EXPECT_FALSE(parse_bar(slot, "2")) << slot;
  }
  for (const char* bar : {"", "6", "-1", "2 ", "02", "x", "/"}) {
    EXPECT_FALSE(parse_bar("0000:00:10.0", bar)) << bar;
  }
}

// A slot that is one can never lead out of its folder.
TEST(PciBar, AnyWordsAreJudged) {
  std::mt19937 random(4);
  constexpr std::string_view kLetters = "0a:./x";
  int slots = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string slot = "0000:00:10.0";
    for (auto changes = random() % 3; changes > 0; --changes) {
      slot[random() % slot.size()] = kLetters[random() % kLetters.size()];
    }
    if (!parse_bar(slot, "0")) continue;
    ++slots;
    EXPECT_EQ(slot.find('/'), std::string::npos);
    EXPECT_EQ(slot.find(".."), std::string::npos);
  }
  EXPECT_GT(slots, 1000);
}

// A folder as sysfs has one for each device, with a board behind BAR 2.
struct BoardInASlot : testing::Test {
  std::filesystem::path devices;
  const PciBar bar{"0000:00:10.0", 2};

  BoardInASlot() {
    std::string folder = testing::TempDir() + "thimble-board-XXXXXX";
    EXPECT_NE(::mkdtemp(folder.data()), nullptr);
    devices = folder;
    std::filesystem::create_directory(devices / bar.slot);
    write("enable", "0\n");
    put_magic(cambus::page::kMagicValue);
  }
  ~BoardInASlot() override { std::filesystem::remove_all(devices); }
  std::filesystem::path file(const char* name) const { return devices / bar.slot / name; }
  void write(const char* name, std::string_view text) const {
    std::ofstream(file(name), std::ios::binary) << text;
  }
  std::string enable() const {
    std::ifstream in(file("enable"));
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void put_magic(std::uint32_t magic) const {
    std::string page(4096, '\0');
    for (std::size_t i = 0; i < 4; ++i) page[i] = static_cast<char>(magic >> 8 * i & 0xff);
    write("resource2", page);
  }
};

TEST_F(BoardInASlot, IsSwitchedOnOnceAndOpened) {
  for (int i = 0; i < 2; ++i) {
    const auto node = open_board(devices, bar);
    ASSERT_TRUE(node) << node.error().message;
    EXPECT_EQ(enable()[0], '1');
    const auto window = linux::MappedWindow::map(*node, "it");
    ASSERT_TRUE(window);
    EXPECT_EQ((*window)->write(8, 7), IoStatus::Ok);
    // The kernel would count a second time.
    write("enable", "1, untouched");
  }
  EXPECT_EQ(enable(), "1, untouched");
}

TEST_F(BoardInASlot, IsGivenToNobodyElseWhileItsMemoryIsUsed) {
  auto node = std::make_unique<Descriptor>(open_board(devices, bar).value());
  EXPECT_EQ(open_board(devices, bar).error().code, Errc::Busy);
  auto window = linux::MappedWindow::map(*node, "it");
  ASSERT_TRUE(window);
  node.reset();
  const auto other = open_board(devices, bar);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, Errc::Busy);
  EXPECT_NE(other.error().message.find("somebody else"), std::string::npos);
  window->reset();
  EXPECT_TRUE(open_board(devices, bar));
}

TEST_F(BoardInASlot, MemoryBehindWhichNoBoardAnswersIsNotHandedOut) {
  for (const std::uint32_t magic : {0U, 0xffffffffU, cambus::page::kMagicValue ^ 1}) {
    put_magic(magic);
    EXPECT_EQ(open_board(devices, bar).error().code, Errc::NotMine) << magic;
  }
}

TEST_F(BoardInASlot, WhatIsNotThereIsNamed) {
  const auto none = open_board(devices, {"0000:00:11.0", 2});
  EXPECT_EQ(none.error().code, Errc::NotFound);
  EXPECT_NE(none.error().message.find("0000:00:11.0"), std::string::npos);
  EXPECT_EQ(open_board(devices, {bar.slot, 3}).error().code, Errc::NotFound);
  write("resource3", "");
  EXPECT_EQ(open_board(devices, {bar.slot, 3}).error().code, Errc::InvalidArgument);
}

TEST_F(BoardInASlot, ALinkInPlaceOfTheMemoryIsNotFollowed) {
  std::filesystem::create_symlink(file("resource2"), file("resource4"));
  EXPECT_FALSE(open_board(devices, {bar.slot, 4}));
}

// Both ends of a connection, as systemd makes it.
struct BoardHelper : BoardInASlot {
  Descriptor listening{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)};
  std::filesystem::path socket = devices / "socket";

  BoardHelper() {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    const std::string path = socket.string();
    std::copy(path.begin(), path.end(), static_cast<char*>(name.sun_path));
    EXPECT_EQ(::bind(listening.get(), reinterpret_cast<const sockaddr*>(&name), sizeof(name)), 0);
    EXPECT_EQ(::listen(listening.get(), 1), 0);
  }
  // What a helper does for one connection.
  template <class Work>
  auto ask(Work work, Duration patience = std::chrono::seconds(20)) {
    std::thread helper([&] {
      const Descriptor connection(::accept(listening.get(), nullptr, nullptr));
      work(connection.get());
    });
    auto window = linux::open_board_window(socket, patience);
    helper.join();
    return window;
  }
};

TEST_F(BoardHelper, HandsTheMemoryOverOpen) {
  const auto window = ask([&](int connection) {
    const auto node = open_board(devices, bar);
    EXPECT_TRUE(linux::send_descriptor(connection, *node));
  });
  ASSERT_TRUE(window) << window.error().message;
  std::uint32_t magic = 0;
  EXPECT_EQ((*window)->read(cambus::page::kMagic, magic), IoStatus::Ok);
  EXPECT_EQ(magic, cambus::page::kMagicValue);
  EXPECT_EQ((*window)->bytes(), 4096U);
}

TEST_F(BoardHelper, WithoutABoardItClosesAndThatIsSaid) {
  const auto window = ask([](int) {});
  ASSERT_FALSE(window);
  EXPECT_EQ(window.error().code, Errc::NotFound);
}

TEST_F(BoardHelper, WhatIsNoOpenFileIsRefused) {
  EXPECT_EQ(ask([](int connection) { ::send(connection, "x", 1, 0); }).error().code,
            Errc::Malformed);
  EXPECT_EQ(ask([](int connection) { ::send(connection, "xy", 2, 0); }).error().code,
            Errc::Malformed);
}

TEST_F(BoardHelper, OneThatSaysNothingIsNotWaitedForLonger) {
  std::promise<void> over;
  std::thread helper([&, ended = over.get_future()] {
    const Descriptor connection(::accept(listening.get(), nullptr, nullptr));
    ended.wait();
  });
  const auto window = linux::open_board_window(socket, std::chrono::milliseconds(1));
  over.set_value();
  helper.join();
  ASSERT_FALSE(window);
  EXPECT_EQ(window.error().code, Errc::Timeout);
}

TEST_F(BoardHelper, ASocketThatIsNotThereIsNamed) {
  const auto window = linux::open_board_window(devices / "none", std::chrono::seconds(1));
  ASSERT_FALSE(window);
  EXPECT_EQ(window.error().code, Errc::NotFound);
  EXPECT_NE(window.error().message.find("thimble-board.socket"), std::string::npos);
}

}  // namespace
}  // namespace thimble::board
