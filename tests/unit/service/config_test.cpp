// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <CLI/CLI.hpp>

#include "common/service/config.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::service {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

struct Nested {
  double depth_m = 4.0;
  void bind(ConfigBinder& binder) { binder.field("depth_m", depth_m, {0.3, 20.0}, "reach"); }
};

struct Sample {
  bool enabled = true;
  int count = 1000;
  std::string mode = "rtd";
  std::vector<std::string> names{"a"};
  std::map<std::string, std::string> levels{{"person", "high"}};
  Nested nested;
  void bind(ConfigBinder& binder) {
    binder.field("enabled", enabled, "switch").option("--enabled");
    binder.field("count", count, {1, 2048}, "how many").option("-c,--count", "Numbers");
    binder.choice("mode", mode, {"off", "rtd"}, "mode", {{"none", "off"}}).option("--mode");
    binder.field("names", names, "list").formerly("filter.words").option("--names");
    binder.field("levels", levels, "map");
    binder.section("nested", nested);
  }
};

class ConfigTest : public ::testing::Test {
 protected:
  ConfigTest() { binder_.section("filter", sample_); }
  std::string write(const std::string& text) const { return folder_.write("test.yaml", text); }
  std::string error_of(const std::string& text) {
    try {
      binder_.load_file(write(text), {"slam"});
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "no error";
  }
  const rtd::test::TemporaryFolder folder_;
  Sample sample_;
  ConfigBinder binder_;
};

TEST_F(ConfigTest, loads_every_kind_of_value) {
  binder_.load_file(
      write("filter: {enabled: false, count: 7, mode: off, names: [x, y], levels: {cat: low}, nested: {depth_m: 2.5}}"),
      {});
  EXPECT_FALSE(sample_.enabled);
  EXPECT_EQ(sample_.count, 7);
  EXPECT_EQ(sample_.mode, "off");
  EXPECT_THAT(sample_.names, ::testing::ElementsAre("x", "y"));
  EXPECT_EQ(sample_.levels.at("cat"), "low");
  EXPECT_DOUBLE_EQ(sample_.nested.depth_m, 2.5);
}

TEST_F(ConfigTest, skips_the_sections_of_other_services) {
  EXPECT_EQ(error_of("slam: {anything: 1}"), "no error");
}

TEST_F(ConfigTest, names_what_is_wrong) {
  const std::pair<std::string, std::vector<std::string>> wrong[] = {
      {"filter: {cuont: 7}", {"filter.cuont", "did you mean 'filter.count'"}},
      {"fliter: {count: 7}", {"filter.count"}},
      {"filter: {count: 5000}", {"filter.count", "5000", "1 to 2048"}},
      {"filter: {count: many}", {"whole number"}},
      {"filter: {nested: {depth_m: .nan}}", {"depth_m"}},
      {"filter: {mode: fast}", {"one of off, rtd"}},
      {"filter:\n  count: [1,\n", {"not valid YAML"}},
      {"filter: {[a, b]: c}", {"not a name"}},
      {"filter: {{a: b}: c}", {"not a name"}},
      {"? [x]\n: y\n", {"not a name"}},
      {"filter:\n  ? " + std::string(500'000, 'x') + "\n  : 1\n", {"unknown key"}}};
  for (const auto& [text, words] : wrong)
    for (const std::string& word : words) EXPECT_THAT(error_of(text), HasSubstr(word)) << text.substr(0, 40);
}

TEST_F(ConfigTest, unknown_key_of_an_own_section_is_an_error_even_when_the_section_is_listed_as_another_ones) {
  EXPECT_THROW(binder_.load_file(write("filter: {cuont: 7}"), {"filter", "slam"}), ConfigError);
  EXPECT_THROW(binder_.set("filter.cuont=7", {"filter", "slam"}), ConfigError);
  EXPECT_NO_THROW(binder_.set("slam.anything=7", {"filter", "slam"}));
}

TEST_F(ConfigTest, former_names_of_choices_and_keys_are_read_as_the_present_ones) {
  EXPECT_EQ(error_of("filter: {mode: none, words: [b, c]}"), "no error");
  EXPECT_EQ(sample_.mode, "off");
  EXPECT_THAT(sample_.names, ::testing::ElementsAre("b", "c"));
}

TEST_F(ConfigTest, anchors_that_hold_themselves_are_an_error) {
  EXPECT_THAT(error_of("filter: &a\n  x: *a\n"), HasSubstr("anchors"));
  std::string bomb = "filter:\n  x: &a0 {}\n";
  for (int i = 0; i < 12; ++i) {
    const std::string below = " *a" + std::to_string(i);
    bomb += "  x" + std::to_string(i) + ": &a" + std::to_string(i + 1) + " {";
    for (int k = 0; k < 20; ++k) bomb += "k" + std::to_string(k) + ":" + below + ", ";
    bomb += "}\n";
  }
  EXPECT_THAT(error_of(bomb), HasSubstr("anchors"));
  EXPECT_EQ(error_of("slam: &a\n  x: *a\nfilter: {count: 3}\n"), "no error") << "a section of others is not read";
  EXPECT_EQ(sample_.count, 3);
}

TEST_F(ConfigTest, missing_file_is_named) {
  EXPECT_THROW(binder_.load_file("/nonexistent/rtd.yaml", {}), ConfigError);
  EXPECT_THROW(binder_.load_file(testing::TempDir(), {}), ConfigError) << "a folder";
}

TEST_F(ConfigTest, set_overrides_one_key) {
  binder_.set("filter.nested.depth_m=1.5");
  EXPECT_DOUBLE_EQ(sample_.nested.depth_m, 1.5);
  EXPECT_THROW(binder_.set("filter.nested.depth_m"), ConfigError);
  EXPECT_NO_THROW(binder_.set("slam.x=1", {"slam"}));
  EXPECT_THROW(binder_.set("slam.x=1"), ConfigError);
}

TEST_F(ConfigTest, printed_config_loads_to_the_same_values) {
  binder_.set("filter.count=77");
  const std::string path = write(binder_.print());
  sample_.count = 1;
  binder_.load_file(path, {});
  EXPECT_EQ(sample_.count, 77);
}

/// A command line with the options of Sample.
class OptionsTest : public ConfigTest {
 protected:
  OptionsTest() { binder_.add_options(app_, given_); }
  /// What `words` give, applied.
  void give(std::vector<std::string> words) {
    app_.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    for (const GivenOption& option : given_) binder_.set(option);
  }
  std::string refused(const std::vector<std::string>& words) {
    try {
      give(words);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "no error";
  }
  CLI::App app_{"a service"};
  std::vector<GivenOption> given_;
};

TEST_F(OptionsTest, set_keys_of_every_kind) {
  give({"-c", "7", "--mode", "off", "--names", "x,y", "--enabled=false"});
  EXPECT_EQ(sample_.count, 7);
  EXPECT_EQ(sample_.mode, "off") << "a choice takes the word, not what YAML makes of it";
  EXPECT_THAT(sample_.names, ::testing::ElementsAre("x", "y"));
  EXPECT_FALSE(sample_.enabled);
}

/// Forwarded as "--mode=", it would take the next word for its value.
TEST_F(OptionsTest, an_empty_value_counts_as_not_given) {
  give({"--mode", "", "--names", "", "--count", "7"});
  EXPECT_EQ(sample_.mode, "rtd");
  EXPECT_THAT(sample_.names, ::testing::ElementsAre("a"));
  EXPECT_THAT(to_command_line(given_, "filter"), ::testing::ElementsAre("--count=7"));
}

TEST_F(OptionsTest, the_last_one_counts) {
  give({"--count", "7", "--count", "8"});
  EXPECT_EQ(sample_.count, 8);
}

TEST_F(OptionsTest, a_value_that_is_not_allowed_names_the_option) {
  EXPECT_EQ(refused({"--count", "5000"}), "--count 5000 is not allowed: use a whole number from 1 to 2048");
  given_.clear();
  EXPECT_EQ(refused({"--mode", "fast"}), "--mode fast is not allowed: use one of off, rtd");
}

TEST_F(OptionsTest, help_comes_from_the_settings) {
  EXPECT_THAT(app_.help(),
              AllOf(ContainsRegex(R"(-c,--count INT(=1000| \[1000\]))"), HasSubstr("How many (filter.count)"),
                    HasSubstr("Numbers:"), ContainsRegex(R"(--mode TEXT:\{off,rtd\}(=rtd| \[rtd\]))")))
      << "a default as CLI11 2.1 or 2.4 writes it";
  EXPECT_THAT(app_.help(), ::testing::Not(HasSubstr("nested")));
}

TEST_F(OptionsTest, are_forwarded_to_the_service_whose_keys_they_are) {
  give({"--names", "x,y", "--count", "7", "--enabled"});
  EXPECT_THAT(to_command_line(given_, "filter", {"filter.count"}),
              ::testing::UnorderedElementsAre("--names=x,y", "--enabled=true"));
  EXPECT_THAT(to_command_line(given_, "slam"), ::testing::IsEmpty());
}

TEST(PartOfASection, leaves_the_other_keys_to_the_service) {
  std::string map;
  ConfigBinder binder;
  binder.part_of_section("slam", [&map](ConfigBinder& slam) { slam.field("map.load", map, "map file"); });
  const std::vector<std::string> sections = {"slam", "filter"};
  binder.load_text("{slam: {map: {load: a.map, save: b.map}, tracker: {whatever: 1}}, filter: {mode: off}}", "text",
                   sections);
  EXPECT_EQ(map, "a.map");
  binder.set("slam.map.save=c.map", sections);
  binder.set("slam.map.load=d.map", sections);
  EXPECT_EQ(map, "d.map");
}

TEST_F(ConfigTest, keys_of_a_section_are_printed_beside_each_other) {
  int late = 1;
  binder_.section("filter.other", sample_.nested);
  binder_.field("filter.nested.late", late, {0, 2}, "bound last");
  EXPECT_THAT(binder_.print(), HasSubstr("    depth_m: 4  # reach\n    late: 1  # bound last\n  other:"));
}

}  // namespace
}  // namespace rtd::service
