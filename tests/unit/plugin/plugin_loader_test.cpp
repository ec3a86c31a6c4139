#include "hal/plugin/plugin_loader.hpp"

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "daemon/session/plugins.hpp"
#include "tests/support/private_copy.hpp"

namespace thimble::plugin {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class PluginLoader : public testing::Test {
 protected:
  std::string planted(const std::string& name) {
    return testing_support::private_copy(folder_, std::string(THIMBLE_PLANTED "/") + name + ".so");
  }
  std::string refusal(const std::string& path) {
    const auto plugin = load_plugin(path);
    return plugin ? "" : plugin.error().message;
  }
  testing_support::TemporaryFolder folder_;
};

TEST_F(PluginLoader, TakesAGoodOneAndRegistersWhatItBrings) {
  const auto plugin = load_plugin(planted("good"));
  ASSERT_TRUE(plugin) << plugin.error().message;
  session::Plugins sut;
  ASSERT_TRUE(register_plugin(**plugin, sut.drivers, sut.models));
  EXPECT_EQ(sut.drivers.drivers().back()->name(), "planted");
  ASSERT_NE(sut.models.find("planted"), nullptr);
  EXPECT_EQ(sut.models.find("planted")->description, "planted");
}

TEST_F(PluginLoader, TakesModelsWithoutADriver) {
  session::Plugins sut;
  const std::size_t drivers = sut.drivers.drivers().size();
  EXPECT_THAT(sut.load({planted("only_model")}), testing::IsEmpty());
  EXPECT_EQ(sut.drivers.drivers().size(), drivers);
  EXPECT_NE(sut.models.find("planted"), nullptr);
}

struct Plant {
  const char* name;
  const char* reason;
};

class PlantedPlugin : public PluginLoader, public testing::WithParamInterface<Plant> {};

TEST_P(PlantedPlugin, IsRefusedInOneSentenceThatNamesFileAndReason) {
  const std::string path = planted(GetParam().name);
  const std::string said = refusal(path);
  EXPECT_THAT(said, AllOf(StartsWith(path + ": "), HasSubstr(GetParam().reason)));
  EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  EXPECT_EQ(refusal(path), said) << "asked again, it says the same";
}

INSTANTIATE_TEST_SUITE_P(
    Loader, PlantedPlugin,
    testing::Values(
        Plant{"no_symbol", "is no plugin: it does not export thimble_plugin_v0"},
        Plant{"undefined", "cannot be loaded: undefined symbol: is_nowhere_defined"},
        Plant{"function", "its thimble_plugin_v0 is not data"},
        Plant{"short", "too small to be a plugin's"},
        Plant{"wrong_magic", "the magic number is wrong"},
        Plant{"other_version", "built for version 1 revision 3"},
        Plant{"other_revision", "built for version 0 revision 99"},
        Plant{"says_smaller", "it says 16 bytes, but has 48"},
        Plant{"says_larger", "it says 65536 bytes, but has 48"},
        Plant{"old_but_larger", "it says 48 bytes, but has 40"},
        Plant{"usb_elsewhere", "its USB driver is not in the file"},
        Plant{"usb_small", "its USB driver says 88 bytes, but has 112"},
        Plant{"usb_without_pipes", "its USB driver claims what no device has"},
        Plant{"usb_many_pipes", "its USB driver claims what no device has"},
        Plant{"usb_missing_function", "its USB driver lacks the function read"},
        Plant{"usb_foreign_function", "its USB driver has a function read that is not in"},
        Plant{"usb_of_its_name", "has two drivers of the name 'planted'"},
        Plant{"nothing", "has neither a driver nor a model"},
        Plant{"driver_elsewhere", "its driver is not in the file"},
        Plant{"driver_nowhere", "its driver is not in the file"},
        Plant{"driver_small", "its driver says 40 bytes, but has 88"},
        Plant{"driver_large", "its driver says 96 bytes, but has 88"},
        Plant{"no_name", "its driver has the name ''"},
        Plant{"odd_name", "its driver has the name 'Not plain'"},
        Plant{"endless_name", "its driver has the name 'aaaa"},
        Plant{"missing_function", "its driver lacks the function decode"},
        Plant{"foreign_function", "its driver has a function decode that is not in the file"},
        Plant{"data_function", "its driver has a function decode that is not in the file"},
        Plant{"between", "its thimble_plugin_v0 is not in the file"},
        Plant{"models_nowhere", "its list of models is not in the file"},
        Plant{"many_models", "has 1000 models, of at most 16"},
        Plant{"twin_models", "has two models of the name 'planted'"},
        Plant{"model_without_function", "its model 1 lacks the function advance"}),
    [](const auto& plant) { return std::string(plant.param.name); });

TEST_F(PluginLoader, TakesDriversOfBareUsbAndPluginsThatAreOlderThanThose) {
  for (const char* name : {"with_usb", "only_usb", "of_revision_1", "of_revision_2"}) {
    session::Plugins sut;
    const std::size_t before = sut.drivers.drivers().size();
    EXPECT_THAT(sut.load({planted(name)}), testing::IsEmpty()) << name;
    const std::size_t added = std::string(name) == "with_usb" ? 2 : 1;
    EXPECT_EQ(sut.drivers.drivers().size(), before + added) << name;
  }
}

TEST_F(PluginLoader, RefusesWhatIsNoSharedObject) {
  const auto text = folder_.write("text.so", "not a shared object, although its name says so");
  EXPECT_THAT(refusal(text.string()), EndsWith("text.so: cannot be loaded: file too short"));
  const auto noise = folder_.write("noise.so", std::string(4096, 'x'));
  EXPECT_THAT(refusal(noise.string()), HasSubstr("invalid ELF header"));
  EXPECT_THAT(refusal((folder_ / "none.so").string()), EndsWith("none.so: there is no such file"));
  EXPECT_THAT(refusal("none.so"), StartsWith("none.so: is not an absolute path"));
}

// The dynamic linker maps what the head promises, and the process dies of the first page without.
TEST_F(PluginLoader, RefusesWhatIsCutShort) {
  const std::string whole = planted("good");
  const auto size = std::filesystem::file_size(whole);
  // A file of its own for each: one that is loaded stays mapped.
  const auto refusal_of = [&](std::uintmax_t bytes) {
    const std::string path = whole + std::to_string(bytes);
    std::filesystem::copy_file(whole, path);
    std::filesystem::resize_file(path, bytes);
    return refusal(path);
  };
  int told = 0;
  for (std::uintmax_t part = 1; part < 16; ++part) {
    const std::string said = refusal_of(size * part / 16);
    if (said.empty()) continue;  // what is missing is for the debugger
    EXPECT_THAT(said, AllOf(StartsWith(whole), Not(HasSubstr("\n"))));
    told += said.find("is cut short") != std::string::npos ? 1 : 0;
  }
  EXPECT_GT(told, 5);
  for (const std::uintmax_t bytes : {0U, 3U, 4U, 63U, 64U, 65U, 200U}) {
    EXPECT_NE(refusal_of(bytes), "") << bytes;
  }
}

TEST_F(PluginLoader, RefusesWhatOthersMayWriteBeforeAnyOfItRuns) {
  const std::string path = planted("good");
  ASSERT_EQ(::chmod(path.c_str(), 0666), 0);
  EXPECT_THAT(refusal(path), HasSubstr("chmod go-w"));
}

TEST_F(PluginLoader, RefusesALibraryOfItThatOthersMayWriteAsOftenAsItIsAsked) {
  const std::string library = planted("library");
  const std::string path = planted("with_library");
  ASSERT_EQ(::chmod(library.c_str(), 0666), 0);
  const std::string said = refusal(path);
  EXPECT_THAT(said, AllOf(StartsWith(path + ": needs the library " + library), EndsWith("go-w)")));
  EXPECT_EQ(refusal(path), said) << "it is mapped by now";
  ASSERT_EQ(::chmod(library.c_str(), 0600), 0);
  EXPECT_EQ(refusal(path), "");
}

// Whether it stays mapped whoever gives it back, and however often.
bool stays_loaded(const std::string& path) {
  for (int i = 0; i < 3; ++i) {
    void* handle = dlopen(path.c_str(), RTLD_LAZY | RTLD_NOLOAD);
    if (handle == nullptr) return false;
    dlclose(handle);
    dlclose(handle);  // another's, if there is one
  }
  return true;
}

TEST_F(PluginLoader, NothingIsEverUnloaded) {
  const std::string good = planted("good");
  ASSERT_EQ(dlopen(good.c_str(), RTLD_LAZY | RTLD_NOLOAD), nullptr);
  {
    session::Plugins owner;
    EXPECT_THAT(owner.load({good}), testing::IsEmpty());
  }
  EXPECT_TRUE(stays_loaded(good)) << "its owner is gone";
  const std::string refused = planted("wrong_magic");
  EXPECT_NE(refusal(refused), "");
  EXPECT_TRUE(stays_loaded(refused)) << "it was refused";
}

TEST_F(PluginLoader, AModelsNameThatIsTakenIsRefusedAndNothingIsAdded) {
  session::Plugins sut;
  const std::size_t drivers = sut.drivers.drivers().size();
  const std::size_t models = sut.models.entries().size();
  const auto refused = sut.load({planted("taken_model")});
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_THAT(refused[0].message, EndsWith(".so: there is a model 'phantom-vintage' already"));
  EXPECT_EQ(sut.drivers.drivers().size(), drivers);
  EXPECT_EQ(sut.models.entries().size(), models);
}

TEST_F(PluginLoader, ADriverWithTheNameOfOneThatIsBuiltInStandsInItsPlace) {
  session::Plugins sut;
  std::vector<std::string> names;
  for (const auto& driver : sut.drivers.drivers()) names.emplace_back(driver->name());
  const Driver* const built_in = sut.drivers.drivers().front().get();
  EXPECT_FALSE(sut.drivers.is_from_outside("phantom"));
  EXPECT_THAT(sut.load({planted("taken_driver")}), testing::IsEmpty());
  ASSERT_EQ(sut.drivers.drivers().size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(sut.drivers.drivers()[i]->name(), names[i]);
    EXPECT_EQ(sut.drivers.is_from_outside(names[i]), names[i] == "phantom");
  }
  EXPECT_NE(sut.drivers.drivers().front().get(), built_in);
}

TEST_F(PluginLoader, OfTwoFromOutsideWithOneNameTheSecondIsRefused) {
  session::Plugins sut;
  const std::string other = planted("taken_driver");
  EXPECT_THAT(sut.load({other, other}),
              testing::ElementsAre(testing::Field(
                  &Error::message, EndsWith("there is a driver 'phantom' from outside already"))));
}

TEST_F(PluginLoader, TheSameFileTwiceIsOneTooMany) {
  session::Plugins sut;
  const std::string path = planted("good");
  EXPECT_THAT(sut.load({path, path}),
              testing::ElementsAre(testing::Field(&Error::message, HasSubstr("already"))));
}

}  // namespace
}  // namespace thimble::plugin
