// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"

namespace rtd::bench {

/// What is sent. Raw frame and features are of fixed size, a JPEG and a pose are not.
enum class Payload { kFrame, kFrame848, kFrame1280, kFrame1920, kJpeg, kFeatures, kPose };
/// The way that it takes on one host.
enum class Path {
  kSharing,       ///< Fast DDS data sharing: stays in the writer's memory, fixed sizes only
  kSharedMemory,  ///< Fast DDS's shared-memory transport
  kUdp,           ///< loopback interface
};

/// One row of the table.
struct TransportCase {
  std::string vendor;
  Path path = Path::kUdp;
  Payload payload = Payload::kFrame;
};

struct TransportOptions {
  std::vector<std::string> vendors;  ///< empty: all of this build
  std::vector<Payload> payloads = {Payload::kFrame, Payload::kJpeg, Payload::kFeatures, Payload::kPose};
  int messages = 200;  ///< for the latency, at rate_hz
  double rate_hz = 30;
  double flood_s = 2;  ///< for the maximum rate
  std::uint32_t domain = 0;
};

/// What the publishing process measured. Times in us, CPU in percent of one core.
struct PublisherResult {
  std::size_t bytes = 0;          ///< of one message
  std::vector<double> memcpy_us;  ///< a plain copy of as many bytes, half a period after each message
  double cpu_percent = 0;         ///< without that copy
  double rate_hz = 0;             ///< three in flight, nothing lost
  std::uint64_t repeated = 0;     ///< messages of that run that never arrived
};

/// What the subscribing process measured.
struct SubscriberResult {
  std::vector<double> latency_us;  ///< from before write() until the callback holds a copy that it may keep
  double cpu_percent = 0;
};

struct TransportResult {
  TransportCase what;
  PublisherResult publisher;
  SubscriberResult subscriber;
  std::string failure;  ///< why there are no numbers; empty: there are
};

const char* to_string(Path path);
const char* to_string(Payload payload);
/// "raw frame 1.5 MB"
const char* title(Payload payload);
std::optional<Payload> parse_payload(const std::string& text);
std::optional<Path> parse_path(const std::string& text);

/// All cases that make sense, payload by payload.
std::vector<TransportCase> transport_cases(const TransportOptions& options);
bus::BusOptions bus_options(const TransportCase& what, std::uint32_t domain, const std::string& name);

}  // namespace rtd::bench
