// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/report/report_html.hpp"

namespace rtd::launcher {

std::string report_html(const RunRecord&, const RunSummary&) {
  return "<!DOCTYPE html><html lang=\"en\"><title>RTD-SLAM</title></html>";
}

}  // namespace rtd::launcher
