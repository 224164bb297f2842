// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "services/launcher/core/completion/completion.hpp"

namespace rtd::launcher {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kRunHelp = R"(Run camera, detector, filter and slam on a source and report
Usage: rtd run [OPTIONS]

Options:
  -h,--help                   Print this help message and exit
  --source TEXT REQUIRED      tum:FOLDER, mcap:FILE [?color=TOPIC] or
                              openni2:[URI], synthetic:NAME
  --pace TEXT:{realtime,asap,lockstep}=realtime
                              realtime, asap or lockstep
  --set TEXT ...              Override one key (repeatable)
  --quiet                     Only warnings and errors
)";

class CompletionTest : public testing::Test {
 protected:
  std::vector<std::string> after(const std::vector<std::string>& words) const { return complete(words, sources_); }

  CompletionSources sources_{
      .commands = {"run", "replay", "topics"},
      .services = {"filter", "slam"},
      .topics = {"/slam/pose", "/slam/odometry"},
      .help = [](const std::vector<std::string>& command) -> std::string {
        if (command == std::vector<std::string>{"run"}) return kRunHelp;
        if (command == std::vector<std::string>{"topics"}) return "Subcommands:\n  list   All\n  echo   Messages\n";
        if (command.size() == 2) return "Options:\n  --domain INT                DDS domain\n";
        return "";
      },
      .config = [](const std::string& service) -> std::string {
        if (service == "slam")
          return "bus:\n  domain: 0  # DDS domain\nslam:\n  base:  # robot\n    frame: base_link\n";
        return service == "filter" ? "bus:\n  domain: 0\nfilter:\n  mode: rtd\n" : "";
      }};
};

TEST_F(CompletionTest, begins_with_the_commands) {
  EXPECT_THAT(after({"re"}), ElementsAre("replay"));
  EXPECT_THAT(after({}), ElementsAre("run", "replay", "topics"));
  EXPECT_THAT(after({"nothing"}), IsEmpty());
}

TEST_F(CompletionTest, takes_options_and_their_values_from_the_help) {
  EXPECT_THAT(after({"run", "--p"}), ElementsAre("--pace"));
  EXPECT_THAT(after({"run", "--pace", ""}), ElementsAre("realtime", "asap", "lockstep"));
  EXPECT_THAT(after({"run", "--pace", "as"}), ElementsAre("asap"));
  EXPECT_THAT(after({"run", "--quiet", "--s"}), ElementsAre("--source", "--set")) << "a flag takes no value";
}

TEST_F(CompletionTest, knows_the_schemes_of_sources_from_the_help) {
  EXPECT_THAT(after({"run", "--source", ""}), ElementsAre("tum:", "mcap:", "openni2:", "synthetic:"));
  EXPECT_THAT(after({"run", "--source", "sy"}), ElementsAre("synthetic:"));
  EXPECT_THAT(after({"run", "--source", "tum:f"}), IsEmpty()) << "the shell's file names";
}

TEST_F(CompletionTest, knows_the_keys_from_the_printed_configuration) {
  EXPECT_THAT(after({"run", "--set", ""}), ElementsAre("bus.domain=", "filter.mode=", "slam.base.frame="));
  EXPECT_THAT(after({"run", "--set", "slam."}), ElementsAre("slam.base.frame="));
}

TEST_F(CompletionTest, knows_subcommands_and_topics) {
  EXPECT_THAT(after({"topics", ""}), ElementsAre("list", "echo"));
  EXPECT_THAT(after({"topics", "echo", "/slam/p"}), ElementsAre("/slam/pose"));
  EXPECT_THAT(after({"topics", "echo", "--"}), ElementsAre("--domain"));
}

}  // namespace
}  // namespace rtd::launcher
