// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/occupancy/octomap_file.hpp"

#include <istream>

#include "common/io/text.hpp"

namespace rtd::occupancy {
namespace {

constexpr int kDepth = 16;  // of an OctoMap: cells from -32768 to 32767
constexpr std::int64_t kMaxCells = 200'000'000;
constexpr std::size_t kMaxBlocks = 80'000;  // of 4 KiB, which one node of two bytes can ask for

/// The cells of the nodes of a .bt file: two bytes a node, two bits a child, children with children of their own
/// behind it, first to last.
class NodeReader {
 public:
  NodeReader(std::istream& in, CellBlocks<Space>& cells) : in_(in), cells_(cells) {}

  void read(const Eigen::Vector3i& corner, int depth) {
    if (depth >= kDepth) throw OctomapError("it is damaged: a node deeper than 16 levels");
    const int low = in_.get(), high = in_.get();
    if (!in_) throw OctomapError("it ends in the middle");
    const int bits = low | high << 8, side = 1 << (kDepth - 1 - depth);
    for (int child = 0; child < 8; ++child) {
      const int kind = bits >> (2 * child) & 3;
      const Eigen::Vector3i at = corner + side * Eigen::Vector3i(child & 1, child >> 1 & 1, child >> 2 & 1);
      if (kind == 3) {
        read(at, depth + 1);
      } else if (kind != 0) {
        fill(at, side, kind == 2 ? Space::kOccupied : Space::kFree);
      }
    }
  }

 private:
  void fill(const Eigen::Vector3i& corner, int side, Space space) {
    filled_ += std::int64_t{side} * side * side;
    if (filled_ > kMaxCells) throw OctomapError("it has more than 200 million cells");
    if (side >= CellBlocks<Space>::kSide) return fill_blocks(corner, side, space);
    auto& block = block_at(CellBlocks<Space>::block_of(corner));
    for (int i = 0; i < side * side * side; ++i) {
      const Eigen::Vector3i at = corner + Eigen::Vector3i(i % side, i / side % side, i / side / side);
      block[static_cast<std::size_t>(CellBlocks<Space>::index(at.x(), at.y(), at.z()))] = space;
    }
  }

  CellBlocks<Space>::Block& block_at(const Eigen::Vector3i& place) {
    if (auto* const block = cells_.at(place, kMaxBlocks)) return *block;
    throw OctomapError("its cells lie in more than 80000 blocks of 16 x 16 x 16");
  }

  /// A cube of whole blocks.
  void fill_blocks(const Eigen::Vector3i& corner, int side, Space space) {
    const Eigen::Vector3i first = CellBlocks<Space>::block_of(corner);
    const int count = side / CellBlocks<Space>::kSide;
    for (int i = 0; i < count * count * count; ++i) {
      block_at(first + Eigen::Vector3i(i % count, i / count % count, i / count / count)).fill(space);
    }
  }

  std::istream& in_;
  CellBlocks<Space>& cells_;
  std::int64_t filled_ = 0;
};

struct Header {
  double cell_m = 0;
  std::string id;
  bool empty = false;  ///< it says that there are no nodes
};

Header read_header(std::istream& in) {
  std::string line;
  if (!io::get_line(in, line) || !line.starts_with(kOctomapFirstLine))
    throw OctomapError("it is not a binary OctoMap (.bt)");
  Header header;
  constexpr int kMaxLines = 100;
  for (int i = 0; i < kMaxLines && io::get_line(in, line) && line != "data"; ++i) {
    const std::string value = line.substr(std::min(line.size(), line.find(' ') + 1));
    if (line.starts_with("id ")) header.id = value;
    if (line.starts_with("res ")) header.cell_m = io::parse_number(value).value_or(0);
    if (line.starts_with("size ")) header.empty = io::parse_number(value) == 0.0;
  }
  if (line != "data") throw OctomapError("its header does not end");
  if (header.id != "OcTree") throw OctomapError("it holds a tree of type '" + header.id + "', not OcTree");
  if (!(header.cell_m >= 1e-3 && header.cell_m <= 100))
    throw OctomapError("its resolution is not one of [0.001, 100] m");
  return header;
}

}  // namespace

Volume read_octomap(std::istream& in) {
  const Header header = read_header(in);
  Volume volume{header.cell_m, {}};
  if (header.empty) return volume;
  NodeReader(in, volume.cells).read(Eigen::Vector3i::Constant(-kOctomapCenter), 0);
  return volume;
}

}  // namespace rtd::occupancy
