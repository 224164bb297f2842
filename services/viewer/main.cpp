// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/run_service.hpp"
#include "services/viewer/viewer_service.hpp"

int main(int argc, char** argv) {
  return rtd::service::run_service<rtd::viewer::ViewerService>(argc, argv);
}
