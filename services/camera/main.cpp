// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/run_service.hpp"
#include "services/camera/camera_service.hpp"
#include "services/camera/export_command.hpp"

int main(int argc, char** argv) {
  if (rtd::camera::wants_export(argc, argv)) return rtd::camera::run_export(argc, argv);
  return rtd::service::run_service<rtd::camera::CameraService>(argc, argv);
}
