// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

namespace rtd::keystore {

/// A line for each enclave: until when, for which domains and topics, or why it cannot be used. True when all can be.
/// Throws security::SecurityError when there is no keystore.
bool print_keystore_info(const std::string& folder, std::int64_t now_s, std::ostream& out);

}  // namespace rtd::keystore
