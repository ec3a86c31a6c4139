#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "daemon/world/io/nrrd.hpp"
#include "tests/unit/world/nrrd_bytes.hpp"
#include "tests/unit/world/nrrd_cell.hpp"
#include "tests/unit/world/volume_files.hpp"

namespace thimble::world {
namespace {

class NrrdFiles : public VolumeFiles {};

TEST_F(NrrdFiles, ADetachedHeaderNamesTheFileBesideIt) {
  NrrdBytes bytes = one_cell();
  const std::string data = bytes.data;
  bytes.more = "data file: sub/a.raw\n";
  bytes.data = "";
  const std::string path = write("a.nhdr", bytes.file());
  const auto missing = load_nrrd_file(path, {});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, Errc::NotFound);
  EXPECT_EQ(missing.error().message,
            path + ": data file: " + folder + "/sub/a.raw: open: No such file or directory");
  std::filesystem::create_directory(folder + "/sub");
  static_cast<void>(write("sub/a.raw", data));
  expect_one_cell(load_nrrd_file(path, {}));
  static_cast<void>(write("sub/a.raw", data + "x"));
  EXPECT_EQ(error_of(load_nrrd_file(path, {})),
            path + ": data: the file has 25 bytes for it, sizes ask for 24");
  std::filesystem::remove(folder + "/sub/a.raw");
  std::filesystem::create_directory(folder + "/sub/a.raw");
  EXPECT_EQ(load_nrrd_file(path, {}).error().code, Errc::InvalidArgument);
}

TEST_F(NrrdFiles, ADetachedHeaderLeadsThroughNoLink) {
  namespace fs = std::filesystem;
  NrrdBytes bytes = one_cell();
  fs::create_directory(folder + "/here");
  fs::create_directory(folder + "/elsewhere");
  const std::string data = write("elsewhere/a.raw", bytes.data);
  fs::create_symlink(data, folder + "/here/link.raw");
  fs::create_symlink("here.raw", folder + "/here/inside.raw");
  fs::create_directory_symlink("../elsewhere", folder + "/here/sub");
  static_cast<void>(write("here/here.raw", bytes.data));
  bytes.data = "";
  const auto said_of = [&](const std::string& name) {
    bytes.more = "data file: " + name + "\n";
    const std::string path = write("here/a.nhdr", bytes.file());
    const auto sut = load_nrrd_file(path, {});
    const auto checked = check_nrrd_file(path, {});
    EXPECT_EQ(error_of(sut), checked ? "none" : checked.error().message);
    const std::string start = path + ": data file: " + folder + "/here/" + name + ": ";
    return error_of(sut).starts_with(start) ? error_of(sut).substr(start.size()) : error_of(sut);
  };
  EXPECT_EQ(said_of("here.raw"), "none");
  EXPECT_EQ(said_of(".//./here.raw"), "none");
  const std::string link = "is a symbolic link, which is not followed";
  EXPECT_EQ(said_of("link.raw"), link + ", expected a regular file");
  EXPECT_EQ(said_of("inside.raw"), link + ", expected a regular file");
  EXPECT_EQ(said_of("sub/a.raw"), "its folder sub " + link);
  EXPECT_EQ(said_of("here.raw/a.raw"), "open: Not a directory");
  // The way to the header is the user's own, links or not.
  fs::create_directory_symlink("here", folder + "/way");
  bytes.more = "data file: here.raw\n";
  static_cast<void>(write("here/a.nhdr", bytes.file()));
  expect_one_cell(load_nrrd_file(folder + "/way/a.nhdr", {}));
}

TEST_F(NrrdFiles, AFileBelowAFolderIsNeverAboveIt) {
  static_cast<void>(write("a.raw", "a"));
  std::filesystem::create_directory(folder + "/sub");
  for (const char* name : {"../a.raw", "..", "sub/../a.raw", "", "sub", "sub/"}) {
    EXPECT_FALSE(open_file_below(folder, name)) << name;
  }
  EXPECT_TRUE(open_file_below(folder, "a.raw"));
}

TEST_F(NrrdFiles, CheckingSaysWhatLoadingWouldSay) {
  NrrdBytes bytes = one_cell();
  const std::string good = bytes.file();
  bytes.sizes = "2 3 1024";
  const std::string lying = bytes.file();
  bytes.sizes = "2 3 4";
  bytes.more = "spacings: 1 1 1000\n";
  for (const std::string& file : {good, lying, bytes.file(), std::string("nonsense")}) {
    const std::string path = write("a.nrrd", file);
    const auto made = load_nrrd_file(path, {});
    const auto checked = check_nrrd_file(path, {});
    ASSERT_EQ(made.has_value(), checked.has_value()) << error_of(made);
    EXPECT_EQ(error_of(made), checked ? "none" : checked.error().message);
  }
  EXPECT_TRUE(check_nrrd_file(write("a.nrrd", good), {}));
}

}  // namespace
}  // namespace thimble::world
