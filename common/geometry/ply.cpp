// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/ply.hpp"

#include <charconv>
#include <istream>
#include <ostream>

#include "common/io/text.hpp"

namespace rtd::geometry {

void write_ply_header(std::ostream& out, PlyFormat format, const std::string& comment, std::size_t vertices,
                      const std::vector<PlyProperty>& properties) {
  out << "ply\nformat " << (format == PlyFormat::kAscii ? "ascii" : "binary_little_endian") << " 1.0\ncomment "
      << comment << "\nelement vertex " << vertices << '\n';
  for (const PlyProperty& property : properties) out << "property " << property.type << ' ' << property.name << '\n';
  out << "end_header\n";
}

std::optional<std::size_t> ply_vertices(std::istream& in) {
  const std::string announced = "element vertex ";
  std::string line;
  if (!io::get_line(in, line) || line != "ply") return std::nullopt;
  while (io::get_line(in, line) && line != "end_header") {
    if (line.rfind(announced, 0) != 0) continue;
    std::size_t count = 0;
    const char* const end = line.data() + line.size();
    const auto [rest, error] = std::from_chars(line.data() + announced.size(), end, count);
    return error == std::errc() && rest == end ? std::optional(count) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace rtd::geometry
