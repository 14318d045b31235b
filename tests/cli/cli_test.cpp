// The option table: what texts become, and what is said of those that make no sense.
#include "tools/common/cli.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "libpreprocess/error.h"
#include "tools/common/exit_codes.h"

namespace tet4d::cli {
namespace {

struct Values {
  std::vector<std::string> files, fields;
  std::string split = "hull", camera;
  double iso = 0.5;
  std::optional<double> error;
  std::uint64_t leaves = 7, bytes = 0;
  std::optional<std::uint64_t> level;
  std::vector<double> weights, times;
  std::array<std::uint32_t, 2> size{0, 0};
  bool json = false;
};

class CliTest : public ::testing::Test {
 protected:
  CliTest() : command_("tool", "Tests the table.") {
    command_.example("tool a b", "two files")
        .positional("FILE", "files", &v_.files)
        .option("--iso", "V", "isovalue", &v_.iso)
        .option("--error", "E", "error", &v_.error)
        .option("--leaves", "N", "leaves", &v_.leaves)
        .option("--level", "N", "level", &v_.level)
        .option("--bytes", "SIZE", "bytes", Size{&v_.bytes})
        .option("--field", "NAME", "fields", &v_.fields)
        .option("--weights", "A,B", "weights", &v_.weights)
        .option("--split", "WAY", "way", Choice{&v_.split, {"hull", "kuhn"}})
        .option("--times", "A:B:STEP", "times", Times{&v_.times})
        .option("--size", "WxH", "size", Extent{&v_.size})
        .option("--camera", "FILE", "camera", &v_.camera)
        .flag("--json", "print JSON", &v_.json)
        .common({kOutput, kThreads, kForce, kSeed, kMemory});
  }

  Parsed parse(std::vector<const char*> words) {
    words.insert(words.begin(), "tool");
    return cli::parse(static_cast<int>(words.size()), words.data(), command_);
  }
  Fault faultOf(std::vector<const char*> words) {
    try {
      parse(std::move(words));
    } catch (const Error& error) {
      return error.fault();
    }
    ADD_FAILURE() << "was accepted";
    return {};
  }

  Values v_;
  Command command_;
};

TEST_F(CliTest, EveryKindOfValue) {
  ASSERT_EQ(parse({"a",
                   "b",
                   "--iso",
                   "-1.5e-3",
                   "--error=+0.25",
                   "--leaves",
                   "18446744073709551615",
                   "--level",
                   "0",
                   "--bytes",
                   "1.5KiB",
                   "--field",
                   "p",
                   "--field",
                   "q",
                   "--weights",
                   "1,-2,3.5",
                   "--split",
                   "kuhn",
                   "--size",
                   "640x480",
                   "--json",
                   "-o",
                   "-",
                   "-j2",
                   "-f",
                   "--seed",
                   "9",
                   "--memory",
                   "2G"}),
            Parsed::kRun);
  EXPECT_EQ(v_.files, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(v_.iso, -1.5e-3);
  EXPECT_EQ(v_.error, 0.25);
  EXPECT_EQ(v_.leaves, 18446744073709551615u);
  EXPECT_EQ(v_.level, 0u);
  EXPECT_EQ(v_.bytes, 1536u);
  EXPECT_EQ(v_.fields, (std::vector<std::string>{"p", "q"}));
  EXPECT_EQ(v_.weights, (std::vector<double>{1, -2, 3.5}));
  EXPECT_EQ(v_.split, "kuhn");
  EXPECT_EQ(v_.size, (std::array<std::uint32_t, 2>{640, 480}));
  EXPECT_TRUE(v_.json);
  const CommonOptions& common = command_.commonOptions();
  EXPECT_EQ(common.output, "-");
  EXPECT_EQ(common.threads, 2u);
  EXPECT_TRUE(common.force);
  EXPECT_EQ(common.seed, 9u);
  EXPECT_EQ(common.memory_bytes, std::uint64_t{2} << 30);
}

TEST_F(CliTest, DefaultsStay) {
  parse({"a"});
  EXPECT_EQ(v_.iso, 0.5);
  EXPECT_EQ(v_.leaves, 7u);
  EXPECT_FALSE(v_.error.has_value());
  EXPECT_FALSE(v_.level.has_value());
}

TEST_F(CliTest, Sizes) {
  const std::vector<std::pair<const char*, std::uint64_t>> cases{{"0", 0},
                                                                 {"12", 12},
                                                                 {"12B", 12},
                                                                 {"1K", 1024},
                                                                 {"1k", 1024},
                                                                 {"3M", 3u << 20},
                                                                 {"1MiB", 1u << 20},
                                                                 {"1MB", 1'000'000},
                                                                 {"0.5KB", 500},
                                                                 {"1.0001K", 1025},
                                                                 {"2T", std::uint64_t{2} << 40}};
  for (const auto& [text, bytes] : cases) {
    parse({"a", "--bytes", text});
    EXPECT_EQ(v_.bytes, bytes) << text;
  }
  for (const char* text : {"", "K", "1Q", "1KiBs", "-1", "1 K", "99999999T", "1.2.3", "1iB"}) {
    EXPECT_EQ(faultOf({"a", "--bytes", text}).code, FaultCode::kUsage) << text;
  }
}

TEST_F(CliTest, TimesIncludeBothEndsAndDoNotDrift) {
  parse({"a", "--times", "0:1:0.1"});
  ASSERT_EQ(v_.times.size(), 11u);
  EXPECT_EQ(v_.times.front(), 0.0);
  EXPECT_EQ(v_.times.back(), 1.0);
  EXPECT_EQ(v_.times[3], 3 * 0.1);
  parse({"a", "--times", "2:7:2"});
  EXPECT_EQ(v_.times, (std::vector<double>{2, 4, 6}));
  parse({"a", "--times", "3:3:1"});
  EXPECT_EQ(v_.times, (std::vector<double>{3}));
  parse({"a", "--times", "1.5,2,0"});
  EXPECT_EQ(v_.times, (std::vector<double>{1.5, 2, 0}));
  for (const char* text :
       {"0:1", "1:0:1", "0:1:0", "0:1:-1", "0:1:nan", "nan:1:1", "0:inf:1", "a", "0:1:1:1", "0:1e9:1", "1,,2", ""}) {
    EXPECT_EQ(faultOf({"a", "--times", text}).code, FaultCode::kUsage) << text;
  }
}

TEST_F(CliTest, ValuesThatAreNone) {
  for (const auto& [option, text] :
       std::vector<std::pair<const char*, const char*>>{{"--iso", "x"},
                                                        {"--iso", "1x"},
                                                        {"--iso", "0x10"},
                                                        {"--leaves", "-1"},
                                                        {"--leaves", "1.5"},
                                                        {"--leaves", "18446744073709551616"},
                                                        {"--size", "640"},
                                                        {"--size", "0x480"},
                                                        {"--size", "640x480x3"},
                                                        {"--iso", "nan"},
                                                        {"--error", "inf"},
                                                        {"--weights", "1,-inf"},
                                                        {"--weights", "1,b"}}) {
    const Fault fault = faultOf({"a", option, text});
    EXPECT_EQ(fault.code, FaultCode::kUsage);
    EXPECT_EQ(fault.place, option);
    EXPECT_NE(fault.what.find(text), std::string::npos) << fault.what;
  }
}

TEST_F(CliTest, AMisspeltOptionNamesTheNearest) {
  for (const auto& [wrong, right] : std::vector<std::pair<const char*, const char*>>{{"--isso", "--iso"},
                                                                                     {"--thread", "--threads"},
                                                                                     {"--out", "--output"},
                                                                                     {"--tiems=0:1:1", "--times"},
                                                                                     {"-json", "--json"},
                                                                                     {"--forse", "--force"}}) {
    const Fault fault = faultOf({"a", wrong});
    EXPECT_EQ(fault.code, FaultCode::kUsage);
    EXPECT_EQ(fault.remedy, std::string("did you mean ") + right + "?") << wrong;
  }
  EXPECT_EQ(faultOf({"a", "--nothing-like-it"}).remedy, "see --help");
  // Even where another complaint could be made.
  EXPECT_EQ(faultOf({"--isso", "1"}).remedy, "did you mean --iso?");
}

TEST_F(CliTest, AMisspeltWordNamesTheNearest) {
  const Fault fault = faultOf({"a", "--split", "khun"});
  EXPECT_NE(fault.what.find("hull, kuhn"), std::string::npos) << fault.what;
  EXPECT_EQ(fault.remedy, "did you mean 'kuhn'?");
}

TEST_F(CliTest, WhatIsMissingIsNamed) {
  EXPECT_EQ(faultOf({}).place, "FILE");
  EXPECT_EQ(faultOf({"a", "--iso"}).code, FaultCode::kUsage);
  EXPECT_EQ(faultOf({"a", "--iso", "1", "--iso", "2"}).code, FaultCode::kUsage);
}

TEST_F(CliTest, HelpAndVersionNeedNothingElse) {
  EXPECT_EQ(parse({"-h"}), Parsed::kHelp);
  EXPECT_EQ(parse({"--iso", "1", "--help"}), Parsed::kHelp);
  EXPECT_EQ(parse({"--version"}), Parsed::kVersion);
}

TEST_F(CliTest, HelpShowsExamplesFirstAndEveryOption) {
  command_.addUniversal();
  const std::string help = helpText(command_);
  EXPECT_LT(help.find("tool a b"), help.find("usage:"));
  EXPECT_LT(help.find("usage:"), help.find("--iso"));
  for (const Option& option : command_.options()) {
    EXPECT_NE(help.find(option.positional ? option.flags : "--" + option.name()), std::string::npos) << option.flags;
  }
  EXPECT_NE(help.find("hull|kuhn"), std::string::npos);
  EXPECT_NE(help.find("isovalue [0.5]"), std::string::npos) << help;
}

TEST_F(CliTest, ProvenanceTellsTheResultNotTheRun) {
  parse({"/data/in/a.nrrd", "--iso", "0.25", "--camera", "/elsewhere/cam.json", "-j", "3", "-o", "/out/b", "--memory",
         "1G"});
  const Session session(command_);
  const std::vector<Input> inputs{{"/data/in/a.nrrd", "00ff"}};
  const std::string text = session.provenance(inputs);
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["program"], "tool");
  EXPECT_EQ(json["options"]["iso"], 0.25);
  EXPECT_EQ(json["options"]["camera"], "cam.json");
  EXPECT_EQ(json["inputs"][0]["name"], "a.nrrd");
  EXPECT_EQ(json["inputs"][0]["digest"], "00ff");
  for (const char* absent : {"threads", "output", "memory", "FILE", "force"}) {
    EXPECT_FALSE(json["options"].contains(absent)) << absent;
  }
  EXPECT_EQ(text.find('/'), std::string::npos) << "a path is in: " << text;
}

TEST(NearestTest, KnowsWhatIsMeantAndWhatIsNot) {
  const std::vector<std::string> words{"auto", "bar", "plain", "json", "none"};
  EXPECT_EQ(nearest("jsno", words), "json");
  EXPECT_EQ(nearest("plian", words), "plain");
  EXPECT_EQ(nearest("pla", words), "plain");
  EXPECT_EQ(nearest("quux", words), "");
  EXPECT_EQ(nearest("", words), "");
}

TEST(ExitCodesTest, AsPromised) {
  EXPECT_EQ(exitCode(FaultCode::kIo), 1);
  EXPECT_EQ(exitCode(FaultCode::kNotBuilt), 1);
  EXPECT_EQ(exitCode(FaultCode::kInterrupted), 1);
  EXPECT_EQ(exitCode(FaultCode::kUsage), 2);
  EXPECT_EQ(exitCode(FaultCode::kBadInput), 3);
  EXPECT_EQ(exitCode(FaultCode::kOutOfMemory), 4);
  EXPECT_EQ(exitCode(FaultCode::kNoSpace), 4);
}

}  // namespace
}  // namespace tet4d::cli
