// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include "common/mcap/codec.hpp"

namespace rtd::mcap {

/// A changed copy: bits, bytes, integers that programs get wrong, blocks moved, repeated or cut, and `other` spliced
/// in.
Bytes mutate(const Bytes& file, const Bytes& other, std::mt19937_64& random);

}  // namespace rtd::mcap
