// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/mcap/compression.hpp"
#include "common/recordings/open.hpp"
#include "services/recorder/people/people_blur.hpp"

namespace rtd::recordings {

/// What a new recording holds, and what it lacks.
struct CopiedRecording {
  std::uint64_t messages = 0, topics = 0, from_ros1 = 0;  ///< from_ros1: messages turned into CDR
  std::map<std::string, std::string> left_out;            ///< topic -> why
  std::vector<std::string> damages;                       ///< of the source, and messages that could not be turned
  std::map<std::string, std::uint64_t> people;            ///< blurred: images by what became of them
};

/// Copies a recording of any form, with all its topics, attachments and metadata, into a new MCAP file in ROS 2's
/// words: CDR byte for byte, ROS 1 messages turned into CDR by the definitions in the bag, other encodings as they are;
/// times and QoS stay. The file is FILE.partial until it is complete. `progress` gets the bytes of the messages read.
/// `people`: has learned the whole source, and blurs images; null: they stay as they are. Throws io::IoError: it
/// exists, disk.
CopiedRecording copy_recording(const Opened& source, const std::filesystem::path& file, mcap::Compression compression,
                               recorder::PeopleBlur* people, const std::function<void(std::uint64_t)>& progress);

/// Where people are in all images of a recording, by the detections in it.
recorder::PeopleBlur people_in(const Opened& source);

}  // namespace rtd::recordings
