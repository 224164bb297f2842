// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/report.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "services/evaluation/core/report/comparison_html.hpp"
#include "services/evaluation/core/report/report_html.hpp"
#include "services/evaluation/core/report/report_json.hpp"

namespace rtd::launcher {
namespace {

void write_file(const std::filesystem::path& path, const std::string& content) {
  std::ofstream output(path, std::ios::binary);
  output << content;
  output.flush();
  if (!output)
    throw std::runtime_error(path.string() + ": cannot be written; check that the folder exists and has room");
}

}  // namespace

RunSummary write_report(const RunRecord& record, const std::filesystem::path& folder) {
  RunSummary summary = summarize_run(record);
  using Json = nlohmann::ordered_json;
  const std::string json = report_json(record, summary).dump(2, ' ', false, Json::error_handler_t::replace);
  write_file(folder / "report.json", json + "\n");
  write_file(folder / "report.html", report_html(record, summary));
  return summary;
}

void write_comparison_html(const std::vector<ComparedRun>& runs, const std::filesystem::path& file) {
  write_file(file, comparison_html(runs));
}

}  // namespace rtd::launcher
