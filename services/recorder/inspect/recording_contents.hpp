// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/io/byte_source.hpp"
#include "common/mcap/problem.hpp"
#include "common/mcap/records.hpp"

namespace rtd::recording {

/// Identifies a message without its payload.
struct Fingerprint {
  mcap::Timestamp log_ns = 0, publish_ns = 0;
  std::uint32_t sequence = 0;
  std::uint64_t bytes = 0;
  std::uint64_t hash = 0;         ///< of the payload
  std::uint64_t stable_hash = 0;  ///< of the payload without the fields of the run
  std::uint64_t key = 0;          ///< the first 8 bytes after the CDR header: our seq or the stamp of a ROS header
};

struct TopicContents {
  std::string type;
  std::vector<Fingerprint> messages;  ///< in file order
};

struct Contents {
  std::map<std::string, TopicContents> topics;
  std::vector<mcap::Problem> problems;
  bool data_lost = false;
};

/// Reads a whole recording. `on_progress` gets the bytes read so far; may be empty.
Contents contents_of(const io::ByteSource& source, const std::function<void(std::uint64_t bytes)>& on_progress = {});

}  // namespace rtd::recording
