#include "cli/world_edit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "daemon/api/request.hpp"

namespace thimble::cli {
namespace {

using testing::StartsWith;
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

TEST(WorldEdit, ThatAWorldHasNoCellsIsTheDaemonsToSay) {
  EXPECT_TRUE(parsed({"fill", {}, {}, {}, {}, {}}, {0, 0, 0}));
}

constexpr std::array<const char*, 5> kOptions{"--min", "--max", "--center", "--radius", "--cell"};
constexpr const char* kVerbs[] = {"fill", "clear", "box", "paint"};

// The options of the bits that are set.
WorldEdit edit_with(const std::string& verb, unsigned said) {
  WorldEdit edit{verb, {}, {}, {}, {}, {}};
  if ((said & 1U) != 0) edit.min = {0, 0, 0};
  if ((said & 2U) != 0) edit.max = {3, 3, 3};
  if ((said & 4U) != 0) edit.center_m = {0, 0, 0};
  if ((said & 8U) != 0) edit.radius_m = 0.01;
  if ((said & 16U) != 0) edit.cell = 1;
  return edit;
}

bool is_good(const std::string& verb, unsigned said) {
  const unsigned without_cell = said & 15U;
  if (verb == "paint") return without_cell == 12;
  return (without_cell == 0 || without_cell == 3) && (verb != "clear" || said < 16);
}

// An option that is said and not allowed, or that is needed and not said: what may be blamed.
std::set<std::string> blamable(const std::string& verb, unsigned said) {
  const unsigned allowed = verb == "paint" ? 28U : verb == "clear" ? 3U : 19U;
  const unsigned extra = said & ~allowed;
  const unsigned missing = verb == "paint" ? 12U & ~said : (said & 3U) == 0 ? 0U : 3U & ~said;
  std::set<std::string> out;
  for (unsigned i = 0; i < kOptions.size(); ++i) {
    if ((((extra != 0 ? extra : missing) >> i) & 1U) != 0) out.insert(kOptions[i]);
  }
  return out;
}

TEST(WorldEdit, NamesAnOptionOfEveryWrongCombinationAndNoneOfTheGoodOnes) {
  for (const std::string verb : kVerbs) {
    for (unsigned said = 0; said < 32; ++said) {
      const WorldEdit edit = edit_with(verb, said);
      const std::string misfit = find_misfit(edit);
      EXPECT_EQ(misfit.empty(), is_good(verb, said)) << verb << " " << said << ": " << misfit;
      if (is_good(verb, said)) {
        EXPECT_TRUE(parsed(edit)) << verb << " " << said;
      } else {
        const std::set<std::string> blame = blamable(verb, said);
        EXPECT_TRUE(std::any_of(
            blame.begin(), blame.end(),
            [&](const std::string& option) { return misfit.find(option) != std::string::npos; }))
            << verb << " " << said << ": " << misfit;
        EXPECT_NE(misfit.find(verb), std::string::npos) << misfit;
      }
    }
  }
}

TEST(WorldEdit, SaysInWordsWhatIsWrong) {
  EXPECT_EQ(find_misfit(edit_with("clear", 16)), "--cell does not go with clear");
  EXPECT_EQ(find_misfit(edit_with("paint", 13)), "--min does not go with paint");
  EXPECT_EQ(find_misfit(edit_with("paint", 0)), "paint needs --center");
  EXPECT_EQ(find_misfit(edit_with("paint", 4)), "paint needs --radius");
  EXPECT_EQ(find_misfit(edit_with("fill", 1)), "fill needs --max beside --min");
}

TEST(WorldEdit, AStateHasAFileAndNothingElse) {
  for (const std::string verb : {"save", "load"}) {
    for (unsigned said = 0; said < 32; ++said) {
      WorldEdit edit = edit_with(verb, said);
      EXPECT_NE(find_misfit(edit), "") << verb << " " << said;
      edit.file = "dish.nrrd";
      EXPECT_EQ(find_misfit(edit).empty(), said == 0) << verb << " " << said;
    }
    EXPECT_EQ(find_misfit(edit_with(verb, 0)), verb + " needs --file");
    EXPECT_TRUE(is_about_state(edit_with(verb, 0)));
  }
  for (const std::string verb : kVerbs) {
    WorldEdit edit = edit_with(verb, verb == "paint" ? 12 : 0);
    EXPECT_EQ(find_misfit(edit), "");
    edit.file = "dish.nrrd";
    EXPECT_EQ(find_misfit(edit), "--file does not go with " + verb);
    EXPECT_FALSE(is_about_state(edit));
  }
}

TEST(WorldEdit, TakesBallsThatTheDaemonTakes) {
  for (const double good_m : {1e-300, 0.01, 1e6}) {
    EXPECT_EQ(find_misfit({"paint", {}, {}, {0, -good_m, good_m}, good_m, {}}), "") << good_m;
  }
  for (const double wrong_m : {0.0, -0.0, -0.01, 1.000001e6}) {
    EXPECT_THAT(find_misfit({"paint", {}, {}, {0, 0, 0}, wrong_m, {}}), StartsWith("--radius"));
  }
  for (const double wrong_m : {-1e300, 1.000001e6}) {
    EXPECT_THAT(find_misfit({"paint", {}, {}, {0, 0, wrong_m}, 1, {}}), StartsWith("--center"));
  }
}

TEST(WorldEdit, NamesTheAxisAlongWhichItEndsBeforeItBegins) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    WorldEdit edit = edit_with("box", 3);
    edit.min[axis] = 4;
    EXPECT_EQ(find_misfit(edit), std::string("--min is beyond --max along ") + "xyz"[axis]);
    edit.min[axis] = 3;
    EXPECT_EQ(find_misfit(edit), "") << "one cell is a block, too";
  }
}

}  // namespace
}  // namespace thimble::cli
