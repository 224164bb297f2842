// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::ros2 {

/// The fields of `struct_name` ("RgbdFrame_") in a text of the OMG's IDL, and those of the types that it is made of,
/// without comments and white space: two texts give the same when samples have the same bytes. Empty when the text does
/// not define it.
std::string layout_in(const std::string& idl, const std::string& struct_name);

}  // namespace rtd::ros2
