#include "daemon/api/request.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/json.hpp>

namespace thimble::api {
namespace {

TEST(ApiRequest, TakesASteadyForceWithinItsBounds) {
  const auto steady = [](std::string_view body) {
    return parse_request("POST", "/v1/arms/right/steady-force", body);
  };
  EXPECT_EQ(steady("{\"up_newton\":-2.5}")->up_newton, -2.5);
  EXPECT_EQ(steady("{\"up_newton\":8}")->up_newton, 8);
  EXPECT_EQ(steady("")->up_newton, std::nullopt);
  EXPECT_EQ(steady("{}")->kind, ActionKind::SteadyForce);
  for (const char* bad : {"{\"up_newton\":8.1}", "{\"up_newton\":-9}", "{\"up_newton\":\"1\"}",
                          "[]", "{\"up_newton\":null}", "{\"down_newton\":1}",
                          "{\"up_newton\":1,\"x\":2}", "{\"up_newton\":1e999}", "3"}) {
    const auto refused = steady(bad);
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().http_status, 400U) << bad;
  }
}

TEST(ApiRequest, TakesAnImpedanceWithinItsBounds) {
  const auto tuned = [](std::string_view body) {
    return parse_request("POST", "/v1/arms/right/impedance", body);
  };
  EXPECT_EQ(tuned("{\"newton_s_per_m\":0.1}")->newton_s_per_m, 0.1);
  EXPECT_EQ(tuned("{\"newton_s_per_m\":40}")->newton_s_per_m, 40);
  EXPECT_EQ(tuned("{\"newton_s_per_m\":7}")->kind, ActionKind::SetImpedance);
  for (const char* bad :
       {"", "{}", "{\"newton_s_per_m\":0.09}", "{\"newton_s_per_m\":40.1}",
        "{\"newton_s_per_m\":-1}", "{\"newton_s_per_m\":\"10\"}", "{\"newton_s_per_m\":null}",
        "{\"newton_s_per_m\":1e999}", "{\"newton_s_per_m\":10,\"x\":1}", "[10]", "10"}) {
    const auto refused = tuned(bad);
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().http_status, 400U) << bad;
  }
  EXPECT_EQ(parse_request("GET", "/v1/arms/right/impedance", "").error().http_status, 405U);
}

TEST(ApiRequest, KnowsItsFourActions) {
  EXPECT_EQ(parse_request("GET", "/v1/status", ""), (Action{ActionKind::Status, ""}));
  EXPECT_EQ(parse_request("POST", "/v1/arms/right/activate", ""),
            (Action{ActionKind::Activate, "right"}));
  EXPECT_EQ(parse_request("POST", "/v1/arms/arm-2/deactivate", "{}"),
            (Action{ActionKind::Deactivate, "arm-2"}));
  EXPECT_EQ(parse_request("POST", "/v1/arms/0/clear-fault", ""),
            (Action{ActionKind::ClearFault, "0"}));
}

TEST(ApiRequest, KnowsTheEditsOfAWorld) {
  constexpr std::string_view kClear = R"({"clear": {"min": [0, 0, 0], "max": [2, 2, 2]}})";
  const auto sut = parse_request("POST", "/v1/worlds/box/edits", kClear);
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->kind, ActionKind::EditWorld);
  EXPECT_EQ(sut->name, "box");
  EXPECT_EQ(sut->edits.size(), 1U);
  EXPECT_EQ(parse_request("GET", "/v1/worlds/box/edits", kClear).error().http_status, 405U);
  EXPECT_EQ(parse_request("POST", "/v1/worlds/box/edits", "").error().http_status, 400U);
  for (const char* target : {"/v1/worlds/box/activate", "/v1/arms/box/edits", "/v1/worlds//edits",
                             "/v1/worlds/Box/edits", "/v1/worlds/box"}) {
    EXPECT_EQ(parse_request("POST", target, kClear).error().http_status, 404U) << target;
  }
}

TEST(ApiRequest, KnowsWhatIsDoneToPieces) {
  const std::pair<const char*, PieceVerb> verbs[] = {{"select", PieceVerb::Select},
                                                     {"drop", PieceVerb::Drop},
                                                     {"delete", PieceVerb::Delete},
                                                     {"free", PieceVerb::Free},
                                                     {"reset", PieceVerb::Reset}};
  for (const auto& [word, verb] : verbs) {
    const std::string target = std::string("/v1/worlds/desk/") + word;
    const auto sut = parse_request("POST", target, "");
    ASSERT_TRUE(sut) << word;
    EXPECT_EQ(sut->kind, ActionKind::ActOnPieces);
    EXPECT_EQ(sut->piece_verb, verb);
    EXPECT_EQ(sut->name, "desk");
    EXPECT_EQ(parse_request("GET", target, "").error().http_status, 405U);
    EXPECT_EQ(parse_request("POST", target, "{\"piece\": 3}").error().http_status, 400U);
  }
  for (const char* word : {"select", "drop", "delete"}) {
    EXPECT_FALSE(parse_request("POST", std::string("/v1/arms/desk/") + word, "")) << word;
  }
}

TEST(ApiRequest, KnowsWhatIsAskedOfTheWorldOfAnArm) {
  const std::pair<const char*, HandVerb> verbs[] = {{"free", HandVerb::Free},
                                                    {"reset", HandVerb::Reset}};
  for (const auto& [word, verb] : verbs) {
    const std::string target = std::string("/v1/arms/right/") + word;
    const auto sut = parse_request("POST", target, "");
    ASSERT_TRUE(sut) << word;
    EXPECT_EQ(sut->kind, ActionKind::AskWorld);
    EXPECT_EQ(sut->hand_verb, verb);
    EXPECT_EQ(sut->name, "right");
    EXPECT_EQ(parse_request("GET", target, "").error().http_status, 405U);
    EXPECT_EQ(parse_request("POST", target, "{\"world\": \"desk\"}").error().http_status, 400U);
  }
}

TEST(ApiRequest, TakesAQuestionForCells) {
  const auto cells = parse_request("GET", "/v1/worlds/dish/cells", "");
  ASSERT_TRUE(cells);
  EXPECT_EQ(cells->kind, ActionKind::ReadCells);
  EXPECT_EQ(cells->name, "dish");
  for (const char* method : {"POST", "PUT"}) {
    const auto other = parse_request(method, "/v1/worlds/dish/cells", "");
    EXPECT_EQ(other.error().http_status, 405U);
    EXPECT_EQ(other.error().allow, "GET");
  }
  EXPECT_FALSE(parse_request("GET", "/v1/arms/dish/cells", ""));
}

TEST(ApiRequest, TakesAnyBytesForAState) {
  const auto save = parse_request("GET", "/v1/worlds/dish/state", "");
  ASSERT_TRUE(save);
  EXPECT_EQ(save->kind, ActionKind::SaveWorld);
  const std::string bytes("NRRD\0\xff{", 7);
  const auto load = parse_request("PUT", "/v1/worlds/dish/state", bytes);
  ASSERT_TRUE(load);
  EXPECT_EQ(load->kind, ActionKind::LoadWorld);
  EXPECT_EQ(load->name, "dish");
  EXPECT_EQ(load->state, bytes);
  const auto other = parse_request("POST", "/v1/worlds/dish/state", bytes);
  EXPECT_EQ(other.error().http_status, 405U);
  EXPECT_EQ(other.error().allow, "GET, PUT");
  EXPECT_EQ(parse_request("PUT", "/v1/worlds/dish/edits", "").error().http_status, 405U);
  EXPECT_EQ(parse_request("GET", "/v1/worlds/dish/state", "[1]").error().http_status, 400U);
  EXPECT_TRUE(may_bring_state("/v1/worlds/dish/state"));
  for (const char* target : {"/v1/worlds/dish/edits", "/v1/arms/dish/state", "/v1/status", ""}) {
    EXPECT_FALSE(may_bring_state(target)) << target;
  }
}

TEST(ApiRequest, AnswersNotFoundToEveryOtherTarget) {
  const std::string long_name(33, 'a');
  for (const std::string& target :
       {std::string(""), std::string("/"), std::string("/v1"), std::string("/v1/status/"),
        std::string("/v1/status?x"), std::string("/v1/events"), std::string("/v1/arms/"),
        std::string("/v1/arms/right"), std::string("/v1/arms/right/"),
        std::string("/v1/arms//activate"), std::string("/v1/arms/Right/activate"),
        std::string("/v1/arms/../activate"), std::string("/v1/arms/a%20/activate"),
        std::string("/v1/arms/right/activate/"), std::string("/v1/arms/a/b/activate"),
        std::string("/v1/arms/a\0b/activate", 20), "/v1/arms/" + long_name + "/activate"}) {
    const auto sut = parse_request("POST", target, "");
    ASSERT_FALSE(sut) << target;
    EXPECT_EQ(sut.error().http_status, 404U) << target;
  }
}

TEST(ApiRequest, NamesTheMethodThatIsAllowed) {
  const auto get = parse_request("GET", "/v1/arms/right/activate", "");
  ASSERT_FALSE(get);
  EXPECT_EQ(get.error().http_status, 405U);
  EXPECT_EQ(get.error().allow, "POST");
  for (const char* method : {"POST", "HEAD", "get", ""}) {
    const auto sut = parse_request(method, "/v1/status", "");
    ASSERT_FALSE(sut);
    EXPECT_EQ(sut.error().allow, "GET");
  }
}

TEST(ApiRequest, ReadsTheFaultThatIsToBeCleared) {
  const auto fault_in = [](std::string_view body) {
    return parse_request("POST", "/v1/arms/right/clear-fault", body);
  };
  EXPECT_EQ(fault_in(R"({"fault": 1})")->fault, 1U);
  EXPECT_EQ(fault_in(R"({"fault": 4294967295})")->fault, 4294967295U);
  EXPECT_EQ(fault_in("")->fault, std::nullopt);
  EXPECT_EQ(fault_in("{}")->fault, std::nullopt);
  for (const char* wrong : {"0", "-1", "1.0", "1.5", "1e0", "4294967296", "18446744073709551617",
                            "1e999", "null", "true", "\"1\"", "[1]", "{}"}) {
    const auto sut = fault_in("{\"fault\": " + std::string(wrong) + "}");
    ASSERT_FALSE(sut) << wrong;
    EXPECT_EQ(sut.error().http_status, 400U);
    EXPECT_THAT(sut.error().message, testing::StartsWith("fault: expected the number")) << wrong;
  }
  for (const char* body : {"3", "[]", R"({"number": 3})", R"({"fault": 3, "arm": "left"})"}) {
    const auto sut = fault_in(body);
    ASSERT_FALSE(sut) << body;
    EXPECT_THAT(sut.error().message, testing::HasSubstr("such as {\"fault\": 3}"));
  }
}

TEST(ApiRequest, RefusesABody) {
  const auto sut = parse_request("POST", "/v1/arms/right/activate", "{\"force\": 1}");
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().http_status, 400U);
}

TEST(ApiRequest, RefusesAKeyThatIsSaidTwiceWhateverIsAsked) {
  for (const char* target : {"/v1/arms/right/activate", "/v1/arms/right/deactivate",
                             "/v1/arms/right/clear-fault", "/v1/worlds/box/edits"}) {
    const auto sut = parse_request(
        "POST", target, R"({"fill": {"min": [0, 0, 0], "max": [1, 1, 1], "min": [1, 1, 1]}})");
    ASSERT_FALSE(sut) << target;
    EXPECT_EQ(sut.error().http_status, 400U);
    EXPECT_EQ(sut.error().message, "the body says the key \"min\" twice in one object");
  }
}

TEST(ApiRequest, TurnsEveryRefusalIntoAStatusOfItsKind) {
  const auto status_of = [](Errc code) { return to_request_error({code, "m"}).http_status; };
  EXPECT_EQ(status_of(Errc::NotFound), 404U);
  EXPECT_EQ(status_of(Errc::Busy), 409U);
  EXPECT_EQ(status_of(Errc::Permission), 403U);
  EXPECT_EQ(status_of(Errc::InvalidArgument), 400U);
  EXPECT_EQ(status_of(Errc::System), 500U);
  EXPECT_EQ(to_request_error({Errc::InvalidArgument, "m"}).code, "invalid-argument");
}

TEST(ApiRequest, WritesErrorsThatAnyTextSurvives) {
  const std::string message = "a \"quoted\"\nline\x01";
  const auto sut = boost::json::parse(to_json(RequestError{400, "malformed", message, ""}));
  EXPECT_EQ(sut.at("error").at("message").as_string(), message);
  EXPECT_EQ(sut.at("error").at("code").as_string(), "malformed");
}

}  // namespace
}  // namespace thimble::api
