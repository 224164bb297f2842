// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <openexr.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "common/camera/depth_formats.hpp"

namespace rtd::camera {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// What is said of the file; caught in decode_exr().
class ExrError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

void require(exr_result_t result) {
  if (result != EXR_ERR_SUCCESS)
    throw ExrError(std::string("is truncated or damaged: ") + exr_get_default_error_message(result));
}

std::int64_t read_memory(exr_const_context_t, void* from, void* to, std::uint64_t size, std::uint64_t at,
                         exr_stream_error_func_ptr_t) {
  const Bytes& bytes = *static_cast<const Bytes*>(from);
  const std::uint64_t count = std::min<std::uint64_t>(size, bytes.size() - std::min<std::uint64_t>(at, bytes.size()));
  if (count > 0) std::memcpy(to, bytes.data() + at, count);
  return static_cast<std::int64_t>(count);
}

/// One part in scan lines.
class ExrReader {
 public:
  explicit ExrReader(Bytes bytes) : bytes_(bytes), unread_(bytes.size()) {
    exr_context_initializer_t memory = EXR_DEFAULT_CONTEXT_INITIALIZER;
    memory.user_data = &bytes_;
    memory.read_fn = read_memory;
    memory.size_fn = [](exr_const_context_t, void* from) {
      return static_cast<std::int64_t>(static_cast<const Bytes*>(from)->size());
    };
    memory.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};  // it would write to stderr
    require(exr_start_read(&file_, "depth", &memory));
  }
  ~ExrReader() {
    exr_decoding_destroy(file_, &decoder_);
    exr_finish(&file_);
  }
  ExrReader(const ExrReader&) = delete;
  ExrReader& operator=(const ExrReader&) = delete;

  cv::Mat read() {
    require_form();
    exr_attr_box2i_t window;
    require(exr_get_data_window(file_, 0, &window));
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1,
                       height = std::int64_t{window.max.y} - window.min.y + 1;
    if (!is_raster_size(width, height)) throw ExrError("has a damaged header or too many pixels");
    image_ = cv::Mat::zeros(static_cast<int>(height), static_cast<int>(width), CV_32FC1);
    const int depth = depth_channel();
    std::int32_t lines = 0;
    require(exr_get_scanlines_per_chunk(file_, 0, &lines));
    for (int row = 0; row < image_.rows; row += lines) read_lines(window.min.y + row, row, depth);
    return image_;
  }

 private:
  void require_form() const {
    int parts = 0;
    exr_storage_t storage{};
    exr_compression_t compression{};
    require(exr_get_count(file_, &parts));
    require(exr_get_storage(file_, 0, &storage));
    require(exr_get_compression(file_, 0, &compression));
    if (parts != 1 || storage != EXR_STORAGE_SCANLINE)
      throw ExrError("is tiled, deep or has several parts: save it as scan lines in one part");
    if (compression > EXR_COMPRESSION_ZIP)
      throw ExrError(
          "is compressed in a way that is not read (PIZ, PXR24, B44, DWA): save it with ZIP or uncompressed");
  }

  /// The one that holds depth: Z, Y, R, V or the first.
  int depth_channel() const {
    constexpr std::size_t kMostBytes = std::size_t{128} << 20;  // of all channels: to unpack, for one of them
    const exr_attr_chlist_t* list = nullptr;
    require(exr_get_channels(file_, 0, &list));
    const std::span channels(list->entries, static_cast<std::size_t>(list->num_channels));
    std::size_t bytes = 0;
    for (const exr_attr_chlist_entry_t& one : channels) {
      if (one.x_sampling != 1 || one.y_sampling != 1) throw ExrError("has a channel that is not read");
      bytes += one.pixel_type == EXR_PIXEL_HALF ? 2 : 4;
    }
    if (channels.empty()) throw ExrError("has a damaged header or too many pixels");
    if (bytes > kMostBytes / image_.total())
      throw ExrError("has " + std::to_string(channels.size()) + " channels, too many for its size: save depth alone");
    for (const char* const name : {"Z", "Y", "R", "V", "depth.Z", "Depth.Z", "Depth.V"}) {
      const auto found =
          std::ranges::find(channels, std::string_view(name), [](const auto& one) { return one.name.str; });
      if (found != channels.end()) return static_cast<int>(found - channels.begin());
    }
    return 0;
  }

  /// A chunk; only depth is unpacked, whatever type it has.
  void read_lines(int y, int row, int depth) {
    exr_chunk_info_t chunk{};
    require(exr_read_scanline_chunk_info(file_, 0, y, &chunk));
    if (chunk.packed_size > unread_) throw ExrError("is damaged: its blocks overlap");
    unread_ -= chunk.packed_size;
    const bool first = decoder_.context == nullptr;
    require((first ? exr_decoding_initialize : exr_decoding_update)(file_, 0, &chunk, &decoder_));
    exr_coding_channel_info_t& channel = decoder_.channels[depth];
    channel.decode_to_ptr = image_.ptr(row);
    channel.user_pixel_stride = channel.user_bytes_per_element = sizeof(float);
    channel.user_line_stride = static_cast<std::int32_t>(image_.step);
    channel.user_data_type = EXR_PIXEL_FLOAT;
    if (first) require(exr_decoding_choose_default_routines(file_, 0, &decoder_));
    require(exr_decoding_run(file_, 0, &decoder_));
  }

  Bytes bytes_;
  std::uint64_t unread_;  ///< bytes that no chunk has had: chunks do not overlap
  exr_context_t file_ = nullptr;
  exr_decode_pipeline_t decoder_ = EXR_DECODE_PIPELINE_INITIALIZER;
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
