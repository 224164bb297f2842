// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/report/comparison_html.hpp"

namespace rtd::launcher {

std::string comparison_html(const std::vector<ComparedRun>&) {
  return "<!DOCTYPE html><html lang=\"en\"><title>RTD-SLAM</title></html>";
}

}  // namespace rtd::launcher
