#include "hal/linux/helper_socket.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "tests/support/temporary_folder.hpp"

namespace thimble::linux {
namespace {

constexpr const char* kAdvice = "(systemctl status thimble-some.socket)";

struct HelperSocket : testing::Test {
  testing_support::TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "socket";
  Descriptor listening{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)};

  void bind() const {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    path.string().copy(static_cast<char*>(name.sun_path), sizeof(name.sun_path) - 1);
    EXPECT_EQ(::bind(listening.get(), reinterpret_cast<const sockaddr*>(&name), sizeof(name)), 0);
  }
  Error refusal() const { return connect_to_helper(path, kAdvice).error(); }
};

TEST_F(HelperSocket, IsConnectedToBeforeAnybodyAccepts) {
  bind();
  ASSERT_EQ(::listen(listening.get(), 1), 0);
  const auto connection = connect_to_helper(path, kAdvice);
  ASSERT_TRUE(connection) << connection.error().message;
  ASSERT_EQ(::send(connection->get(), "word", 4, 0), 4);
  const Descriptor accepted(::accept(listening.get(), nullptr, nullptr));
  std::string word(9, '\0');
  EXPECT_EQ(::recv(accepted.get(), word.data(), word.size(), 0), 4) << "packets are kept apart";
}

TEST_F(HelperSocket, OneThatIsNotThereIsToldFromOneThatDoesNotAnswer) {
  EXPECT_EQ(refusal().code, Errc::NotFound);
  bind();
  const Error error = refusal();
  EXPECT_EQ(error.code, Errc::System);
  EXPECT_EQ(error.message,
            path.string() + " (systemctl status thimble-some.socket): Connection refused");
}

// Its owner does not come to accept: nobody waits for that.
TEST_F(HelperSocket, WhereTooManyWaitTheNextIsRefused) {
  bind();
  ASSERT_EQ(::listen(listening.get(), 0), 0);
  const auto first = connect_to_helper(path, kAdvice);
  ASSERT_TRUE(first);
  EXPECT_EQ(refusal().code, Errc::Busy);
}

TEST_F(HelperSocket, APathThatNoSocketCanHaveIsNone) {
  path.clear();
  EXPECT_EQ(refusal().code, Errc::InvalidArgument);
  path = std::string(sizeof(sockaddr_un{}.sun_path) - 1, 'x');
  EXPECT_EQ(refusal().code, Errc::NotFound);
  path += 'x';
  EXPECT_EQ(refusal().code, Errc::InvalidArgument);
}

}  // namespace
}  // namespace thimble::linux
