// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/rosbag1/chunk_codec.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
#include <memory>

namespace rtd::rosbag1 {
namespace {

using Content = std::vector<std::uint8_t>;

constexpr std::size_t kFirstGuess = std::size_t{4} << 20U;

/// Room for more output: what is claimed, but doubling from kFirstGuess on.
void grow(Content& content, std::size_t size) {
  content.resize(std::min(size, std::max(kFirstGuess, 2 * content.size())));
}

void check_size(std::size_t found, std::size_t size) {
  if (found == size) return;
  throw ros::WireError("a chunk holds " + std::to_string(found) + " bytes but claims " + std::to_string(size));
}

Content decompress_bz2(Content& data, std::size_t size) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> guard(&stream, BZ2_bzDecompressEnd);
  stream.next_in = reinterpret_cast<char*>(data.data());
  stream.avail_in = static_cast<unsigned>(data.size());
  Content content;
  std::size_t found = 0;
  for (int status = BZ_OK; status != BZ_STREAM_END;) {
    if (found == content.size()) grow(content, size);
    stream.next_out = reinterpret_cast<char*>(content.data() + found);
    stream.avail_out = static_cast<unsigned>(content.size() - found);
    const std::size_t room = stream.avail_out, left = stream.avail_in;
    status = BZ2_bzDecompress(&stream);
    found += room - stream.avail_out;
    if (status != BZ_OK && status != BZ_STREAM_END) throw ros::WireError("a bz2 chunk is damaged");
    const bool stuck = stream.avail_out == room && stream.avail_in == left;
    if (stuck && status != BZ_STREAM_END) throw ros::WireError("a bz2 chunk ends early or is longer than it claims");
  }
  check_size(found, size);
  return content;
}

Content decompress_lz4(const Content& data, std::size_t size) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> guard(context, LZ4F_freeDecompressionContext);
  Content content;
  std::size_t found = 0, used = 0;
  for (std::size_t hint = 1; hint != 0;) {
    if (found == content.size()) grow(content, size);
    std::size_t produced = content.size() - found, consumed = data.size() - used;
    hint = LZ4F_decompress(context, content.data() + found, &produced, data.data() + used, &consumed, nullptr);
    if (LZ4F_isError(hint) != 0)
      throw ros::WireError(std::string("an lz4 chunk is damaged: ") + LZ4F_getErrorName(hint));
    found += produced, used += consumed;
    if (hint != 0 && produced == 0 && consumed == 0) {
      throw ros::WireError("an lz4 chunk ends early or is longer than it claims");
    }
  }
  check_size(found, size);
  return content;
}

}  // namespace

Content decompress(const std::string& compression, Content data, std::size_t size) {
  if (compression == "none") {
    check_size(data.size(), size);
    return data;
  }
  if (compression == "bz2") return decompress_bz2(data, size);
  if (compression == "lz4") return decompress_lz4(data, size);
  throw ros::WireError("unknown compression '" + compression + "'; known: none, bz2, lz4");
}

}  // namespace rtd::rosbag1
