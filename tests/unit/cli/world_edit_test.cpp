#include "cli/world_edit.hpp"

#include <gtest/gtest.h>

#include "daemon/api/request.hpp"

namespace thimble::cli {
namespace {

using Kind = api::CellEdit::Kind;

using Understood = tl::expected<api::Action, api::RequestError>;

// What the daemon makes of it.
Understood parsed(const WorldEdit& edit, const std::array<std::uint32_t, 3>& cells = {4, 5, 6}) {
  return api::parse_request("POST", "/v1/worlds/box/edits", body_of(edit, cells));
}

api::CellEdit understood(const WorldEdit& edit) {
  const Understood action = parsed(edit);
  EXPECT_TRUE(action) << (action ? "" : action.error().message);
  return action ? action->edits.at(0) : api::CellEdit{};
}

TEST(WorldEdit, SaysWhatTheDaemonUnderstands) {
  EXPECT_EQ(understood({"fill", {0, 1, 2}, {3, 3, 3}, {}, {}, 3}),
            (api::CellEdit{Kind::Fill, {0, 1, 2}, {3, 3, 3}, {}, 0, 3}));
  EXPECT_EQ(understood({"paint", {}, {}, {0.01, -0.02, 0}, 0.005, {}}),
            (api::CellEdit{Kind::Paint, {}, {}, {0.01, -0.02, 0}, 0.005, 1}));
}

TEST(WorldEdit, CellsThatAreNotSaidAreAllOfTheWorld) {
  EXPECT_EQ(understood({"clear", {}, {}, {}, {}, {}}),
            (api::CellEdit{Kind::Fill, {0, 0, 0}, {3, 4, 5}, {}, 0, 0}));
  EXPECT_EQ(understood({"box", {}, {}, {}, {}, {}}),
            (api::CellEdit{Kind::Box, {0, 0, 0}, {3, 4, 5}, {}, 0, 1}));
}

TEST(WorldEdit, HalfOfWhatIsNeededIsLeftToTheDaemonToRefuse) {
  EXPECT_FALSE(parsed({"fill", {0, 0, 0}, {}, {}, {}, {}}));
  EXPECT_FALSE(parsed({"paint", {}, {}, {}, 0.01, {}}));
  EXPECT_FALSE(parsed({"clear", {}, {}, {}, {}, 1}));
  EXPECT_TRUE(parsed({"fill", {}, {}, {}, {}, {}}, {0, 0, 0}))
      << "that it has no cells is the daemon's to say";
}

TEST(WorldEdit, NamesTheOptionThatDoesNotGoWithTheVerb) {
  for (const std::string verb : {"fill", "clear", "box"}) {
    EXPECT_EQ(find_misfit({verb, {0, 0, 0}, {1, 1, 1}, {}, {}, {}}), "");
    EXPECT_EQ(find_misfit({verb, {}, {}, {0, 0, 0}, {}, {}}), "--center does not go with " + verb);
    EXPECT_EQ(find_misfit({verb, {}, {}, {}, 0.1, {}}), "--radius does not go with " + verb);
    EXPECT_EQ(find_misfit({verb, {}, {}, {}, {}, 0}),
              verb == "clear" ? "--cell does not go with clear" : "");
  }
  EXPECT_EQ(find_misfit({"paint", {}, {}, {0, 0, 0}, 0.1, 1}), "");
  EXPECT_EQ(find_misfit({"paint", {0, 0, 0}, {}, {}, {}, {}}), "--min does not go with paint");
  EXPECT_EQ(find_misfit({"paint", {}, {0, 0, 0}, {}, {}, {}}), "--max does not go with paint");
}

}  // namespace
}  // namespace thimble::cli
