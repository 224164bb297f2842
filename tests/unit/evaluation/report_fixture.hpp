// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "services/evaluation/core/report/report.hpp"
#include "tests/support/evaluation_page/rendered.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/evaluation/fabricated_run.hpp"

namespace rtd::eval {

/// The fabricated run with files: ground truth, and a final trajectory that is too large by 10 %.
class Report : public testing::Test {
 protected:
  Report() : record_(testing_support::fabricated_run()) {
    const Trajectory truth = testing_support::winding_path(100, 0.1);
    record_.groundtruth_path = folder_.write("groundtruth.txt", testing_support::tum_text(truth));
    record_.trajectory_path =
        folder_.write("trajectory.txt",
                      testing_support::tum_text(testing_support::moved(truth, testing_support::some_transform(), 1.1)));
    record_.samples = {testing_support::fabricated_sample(3), testing_support::fabricated_sample(50)};
  }

  /// As it is printed.
  nlohmann::ordered_json json() const {
    return nlohmann::ordered_json::parse(report_json(record_, summarize_run(record_)).dump());
  }
  std::string page() const { return report_html(record_, summarize_run(record_)); }
  /// What the page shows.
  std::string shown() const { return shown(page()); }
  std::string shown(const std::string& html) const {
    return testing_support::rendered(html, folder_.file("page.html"));
  }

  rtd::test::TemporaryFolder folder_;
  eval::Run record_;
};

/// What the script of a page draws; node runs it.
class ShownReport : public Report {
 protected:
  void SetUp() override {
    if (!testing_support::has_node()) GTEST_SKIP() << "node is not installed; deploy/setup.sh --viewers installs it";
  }
};

}  // namespace rtd::eval
