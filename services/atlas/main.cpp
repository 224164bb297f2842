// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "common/service/run_service.hpp"
#include "services/atlas/atlas_service.hpp"
#include "services/atlas/status_command.hpp"

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "status") return rtd::atlas::run_status(argc - 1, argv + 1);
  return rtd::service::run_service<rtd::atlas::AtlasService>(argc, argv);
}
