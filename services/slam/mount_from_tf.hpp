// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/service/runtime.hpp"
#include "services/slam/config.hpp"

namespace rtd::slam {

/// The configuration with base.camera=tf replaced by what `rt/tf_static` says: waits until its transforms join the base
/// with the camera's optical frame, and says every few seconds what is missing. Throws service::ConfigError when
/// base.tf_timeout_s pass without. Any other configuration comes back as it is, at once.
ServiceConfig with_mount(ServiceConfig config, service::Runtime& runtime);

}  // namespace rtd::slam
