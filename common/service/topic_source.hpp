// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/bus/source_gate.hpp"
#include "common/service/runtime.hpp"

namespace rtd::service {

/// Whether the process of a connection is known to have ended: Heartbeat::gone() or ProcessRegistry::gone().
using ProcessGone = std::function<bool(const bus::ParticipantId&)>;

/// A gate for the topics that one service writes, e.g. "camera": the first one is followed, others are refused and
/// named in the log. Where another source may take over without harm, `silence_ns` is shorter.
std::shared_ptr<bus::SourceGate> follow_source(const std::string& service, ProcessGone gone,
                                               std::int64_t silence_ns = bus::SourceGate::kSilenceNs);
/// The same for a service whose heartbeats matter, too: in a secured domain they count only from a connection that is
/// matched as a writer behind the gate, which the keys of another service do not allow.
std::shared_ptr<bus::SourceGate> follow_source(const std::string& service, Runtime& runtime,
                                               std::int64_t silence_ns = bus::SourceGate::kSilenceNs);

/// Boxes are judged image by image: those of another detector do no harm once the first one pauses.
inline constexpr std::int64_t kDetectorSilenceNs = 1'000'000'000;

}  // namespace rtd::service
