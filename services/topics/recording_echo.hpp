// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

#include "services/topics/topics_command.hpp"

namespace rtd::topics {

/// Whether the argument of `rtd topics echo` is a recording, not a topic: a file, a name that ends as recordings do, or
/// a folder with a recording.
bool is_recording(const std::string& argument);

/// Prints the messages of a recording, request.topics.front(), in the order of recording: those of the topics named
/// behind it, else of all whose types can be read. Exit code 0; 1: no message of these topics; 2: no recording, no such
/// topic, a topic whose type cannot be read; 3: damage, or a message that does not match its type. Throws
/// mcap::RecordingFileError when the file cannot be read.
int echo_recording(const TopicsRequest& request, std::ostream& out, std::ostream& err);

}  // namespace rtd::topics
