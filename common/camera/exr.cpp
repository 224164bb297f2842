// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/camera/depth_formats.hpp"

namespace rtd::camera {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Block = std::vector<std::uint8_t>;

/// What is said of the file; caught in decode_exr().
class ExrError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ExrBytes {
 public:
  explicit ExrBytes(Bytes bytes) : bytes_(bytes) {}

  template <class Number>
  Number take() {
    Number number;
    std::memcpy(&number, take(sizeof(Number)).data(), sizeof(Number));
    return number;
  }
  Bytes take(std::size_t size) {
    if (size > bytes_.size() - at_) throw ExrError("is truncated");
    at_ += size;
    return bytes_.subspan(at_ - size, size);
  }
  /// Up to a zero.
  std::string take_text() {
    std::string text;
    while (const auto letter = take<char>()) text += letter;
    return text;
  }
  Bytes rest() const { return bytes_.subspan(at_); }
  bool at_end() const { return at_ == bytes_.size(); }
  void go_to(std::uint64_t at) {
    if (at > bytes_.size()) throw ExrError("is truncated");
    at_ = static_cast<std::size_t>(at);
  }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
};

struct Channel {
  std::string name;
  std::uint32_t type;  ///< 0 = 32-bit integer, 1 = half, 2 = float
  std::size_t bytes() const { return type == 1 ? 2 : 4; }
};

std::vector<Channel> read_channels(Bytes value) {
  std::vector<Channel> channels;
  for (ExrBytes bytes(value); !bytes.at_end();) {
    Channel channel{bytes.take_text(), 0};
    if (channel.name.empty()) break;
    channel.type = bytes.take<std::uint32_t>();
    bytes.take<std::uint32_t>();  // linear, and three bytes of nothing
    const auto step_x = bytes.take<std::uint32_t>(), step_y = bytes.take<std::uint32_t>();
    if (channel.type > 2 || step_x != 1 || step_y != 1) throw ExrError("has a channel that is not read");
    channels.push_back(std::move(channel));
  }
  return channels;
}

/// Runs of a byte, and of bytes that differ.
Block expand_runs(Bytes packed, std::size_t size) {
  Block block;
  for (std::size_t at = 0; at < packed.size() && block.size() < size;) {
    const auto count = static_cast<std::int8_t>(packed[at++]);
    const auto run = static_cast<std::size_t>(count < 0 ? -count : count + 1);
    if (at + (count < 0 ? run : 1) > packed.size()) break;
    for (std::size_t i = 0; i < run; ++i) block.push_back(packed[count < 0 ? at + i : at]);
    at += count < 0 ? run : 1;
  }
  return block;
}

/// The bytes of some lines. Packed ones are in two halves: those at even places first.
struct Lines {
  Bytes bytes;
  bool in_halves;

  void copy(std::size_t from, std::span<std::uint8_t> to) const {
    const std::size_t half = (bytes.size() + 1) / 2;
    for (std::size_t i = from; i < from + to.size(); ++i)
      to[i - from] = bytes[!in_halves ? i : i % 2 == 0 ? i / 2 : half + i / 2];
  }
};

class ExrReader {
 public:
  explicit ExrReader(Bytes bytes) : file_(bytes), unread_(bytes.size()) {}

  cv::Mat read() {
    read_header();
    const std::int64_t width = std::int64_t{window_[2]} - window_[0] + 1,
                       height = std::int64_t{window_[3]} - window_[1] + 1;
    if (!is_raster_size(width, height) || channels_.empty()) throw ExrError("has a damaged header or too many pixels");
    image_ = cv::Mat::zeros(static_cast<int>(height), static_cast<int>(width), CV_32FC1);
    lay_out_line();
    const int lines = lines_per_block();
    std::vector<std::uint64_t> offsets(static_cast<std::size_t>((image_.rows + lines - 1) / lines));
    for (std::uint64_t& offset : offsets) offset = file_.take<std::uint64_t>();
    for (const std::uint64_t offset : offsets) read_block(offset, lines);
    return image_;
  }

 private:
  void read_header() {
    constexpr std::uint32_t kVersion = 2, kLongNames = 0x400;  // other flags: tiles, deep data, several parts
    file_.take(4);
    if ((file_.take<std::uint32_t>() & ~kLongNames) != kVersion)
      throw ExrError("is tiled, deep or has several parts: save it as scan lines in one part");
    for (std::string name = file_.take_text(); !name.empty(); name = file_.take_text()) {
      file_.take_text();  // type
      ExrBytes value(file_.take(file_.take<std::uint32_t>()));
      if (name == "compression") compression_ = value.take<std::uint8_t>();
      if (name == "dataWindow") window_ = value.take<std::array<std::int32_t, 4>>();
      if (name == "channels") channels_ = read_channels(value.rest());
    }
  }

  int lines_per_block() const {
    constexpr std::uint8_t kNone = 0, kRuns = 1, kZipLine = 2, kZip = 3;
    if (compression_ == kNone || compression_ == kRuns || compression_ == kZipLine) return 1;
    if (compression_ == kZip) return 16;
    throw ExrError("is compressed in a way that is not read (PIZ, PXR24, B44, DWA): save it with ZIP or uncompressed");
  }

  /// A line has the values of one channel behind those of the other.
  void lay_out_line() {
    constexpr std::size_t kMostBytes = std::size_t{128} << 20;  // of all channels: to unpack, for one of them
    const auto depth = depth_channel();
    const auto columns = static_cast<std::size_t>(image_.cols);
    type_ = depth->type;
    value_bytes_ = depth->bytes();
    for (auto channel = channels_.begin(); channel != channels_.end(); ++channel) {
      if (channel == depth) depth_at_ = line_bytes_;
      line_bytes_ += channel->bytes() * columns;
    }
    if (line_bytes_ > kMostBytes / static_cast<std::size_t>(image_.rows))
      throw ExrError("has " + std::to_string(channels_.size()) + " channels, too many for its size: save depth alone");
  }

  /// The one that holds depth.
  std::vector<Channel>::const_iterator depth_channel() const {
    for (const char* const name : {"Z", "Y", "R", "V", "depth.Z", "Depth.Z", "Depth.V"}) {
      const auto found = std::ranges::find(channels_, name, &Channel::name);
      if (found != channels_.end()) return found;
    }
    return channels_.begin();
  }

  void read_block(std::uint64_t offset, int lines) {
    file_.go_to(offset);
    const std::int64_t first = std::int64_t{file_.take<std::int32_t>()} - window_[1];
    const Bytes packed = file_.take(file_.take<std::uint32_t>());
    if (first < 0 || first >= image_.rows || packed.size() > unread_) throw ExrError("is damaged");
    unread_ -= packed.size();
    lines = std::min(lines, image_.rows - static_cast<int>(first));
    const std::size_t size = line_bytes_ * static_cast<std::size_t>(lines);
    const bool stored = compression_ == 0 || packed.size() >= size;  // it did not get smaller
    const Block block = stored ? Block() : unpack(packed, size);
    if ((stored ? packed.size() : block.size()) < size) throw ExrError("is truncated or damaged");
    for (int line = 0; line < lines; ++line)
      copy_line({stored ? packed : block, !stored}, line, static_cast<int>(first) + line);
  }

  /// Bytes are stored as differences.
  Block unpack(Bytes packed, std::size_t size) const {
    Block block = compression_ == 1 ? expand_runs(packed, size) : inflate_at_most(packed, size);
    for (std::size_t i = 1; i < block.size(); ++i) block[i] = static_cast<std::uint8_t>(block[i - 1] + block[i] - 128);
    return block;
  }

  void copy_line(const Lines& from, int line, int row) {
    Block values(value_bytes_ * static_cast<std::size_t>(image_.cols));
    from.copy(static_cast<std::size_t>(line) * line_bytes_ + depth_at_, values);
    auto* const to = image_.ptr<float>(row);
    for (int column = 0; column < image_.cols; ++column) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, values.data() + static_cast<std::size_t>(column) * value_bytes_, value_bytes_);
      to[column] = type_ == 1   ? half_to_float(static_cast<std::uint16_t>(bits))
                   : type_ == 2 ? std::bit_cast<float>(bits)
                                : static_cast<float>(bits);
    }
  }

  ExrBytes file_;
  std::size_t unread_;  ///< bytes that no block has had: blocks do not overlap
  std::uint8_t compression_ = 0;
  std::array<std::int32_t, 4> window_{0, 0, -1, -1};  ///< x and y from, x and y to
  std::vector<Channel> channels_;
  std::size_t line_bytes_ = 0, depth_at_ = 0, value_bytes_ = 0;  ///< of a line, of depth in it, of one value of it
  std::uint32_t type_ = 0;
  cv::Mat image_;
};

}  // namespace

vision::DecodedImage decode_exr(Bytes bytes) {
  try {
    return {ExrReader(bytes).read(), {}};
  } catch (const ExrError& error) {
    return {{}, error.what()};
  }
}

}  // namespace rtd::camera
