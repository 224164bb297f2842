// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace rtd::geometry {

enum class PlyFormat { kAscii, kBinaryLittleEndian };

/// One value of a vertex: `type` is a PLY type, e.g. "float" or "uchar".
struct PlyProperty {
  std::string type, name;
};

/// The header of a PLY file that holds points only; the vertices follow.
void write_ply_header(std::ostream& out, PlyFormat format, const std::string& comment, std::size_t vertices,
                      const std::vector<PlyProperty>& properties);

/// Number of points that the header announces; empty when it is not a PLY header.
std::optional<std::size_t> ply_vertices(std::istream& in);

}  // namespace rtd::geometry
