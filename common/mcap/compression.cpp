// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/compression.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include <limits>
#include <stdexcept>

namespace rtd::mcap {
namespace {

std::size_t checked_lz4(std::size_t result) {
  if (LZ4F_isError(result) != 0) throw std::runtime_error(std::string("lz4: ") + LZ4F_getErrorName(result));
  return result;
}

std::size_t checked_zstd(std::size_t result) {
  if (ZSTD_isError(result) != 0) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(result));
  return result;
}

ByteView compress_lz4(ByteView data, Buffer& out) {
  LZ4F_preferences_t preferences = LZ4F_INIT_PREFERENCES;
  preferences.frameInfo.contentSize = data.size();
  preferences.frameInfo.blockSizeID = LZ4F_max4MB;
  const std::span<std::byte> to = out.reset(LZ4F_compressFrameBound(data.size(), &preferences));
  return to.first(checked_lz4(LZ4F_compressFrame(to.data(), to.size(), data.data(), data.size(), &preferences)));
}

ByteView compress_zstd(ByteView data, Buffer& out) {
  const std::span<std::byte> to = out.reset(ZSTD_compressBound(data.size()));
  return to.first(checked_zstd(ZSTD_compress(to.data(), to.size(), data.data(), data.size(), ZSTD_CLEVEL_DEFAULT)));
}

using Lz4Context =
    std::unique_ptr<LZ4F_dctx, decltype([](LZ4F_dctx* context) { LZ4F_freeDecompressionContext(context); })>;
using ZstdContext = std::unique_ptr<ZSTD_DCtx, decltype([](ZSTD_DCtx* context) { ZSTD_freeDCtx(context); })>;

Lz4Context lz4_context() {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) throw std::bad_alloc();
  return Lz4Context(context);
}

/// Bytes written into `to`; more input than output is an error.
std::size_t decompress_lz4(LZ4F_dctx* context, ByteView data, std::span<std::byte> to) {
  LZ4F_resetDecompressionContext(context);
  LZ4F_decompressOptions_t options{};
  options.stableDst = 1;
  std::size_t done = 0;
  std::size_t hint = 1;  // 0: the frame is complete
  while (!data.empty() && hint != 0) {
    std::size_t written = to.size() - done;
    std::size_t read = data.size();
    hint = checked_lz4(LZ4F_decompress(context, to.data() + done, &written, data.data(), &read, &options));
    done += written;
    data = data.subspan(read);
    if (read == 0 && written == 0) throw std::runtime_error("lz4: holds more than the chunk says");
  }
  if (hint != 0) throw std::runtime_error("lz4: the frame is not complete");
  return done;
}

}  // namespace

std::string name_of(Compression compression) {
  constexpr const char* kNames[] = {"", "lz4", "zstd"};
  return kNames[static_cast<std::size_t>(compression)];
}

std::optional<Compression> compression_of(const std::string& name) {
  for (const Compression compression : {Compression::kNone, Compression::kLz4, Compression::kZstd})
    if (name == name_of(compression)) return compression;
  return std::nullopt;
}

ByteView compress(Compression compression, ByteView data, Buffer& out) {
  if (compression == Compression::kLz4) return compress_lz4(data, out);
  if (compression == Compression::kZstd) return compress_zstd(data, out);
  return data;
}

std::uint64_t largest_uncompressed_size(Compression compression, std::uint64_t compressed_size) {
  // LZ4 grows a match by at most 255 bytes a byte; zstd repeats a byte over a block of 128 KiB in four bytes.
  const std::uint64_t ratio =
      compression == Compression::kNone ? 1 : (compression == Compression::kLz4 ? 255 : 128 * 1024 / 4);
  const std::uint64_t most = std::numeric_limits<std::uint64_t>::max() / ratio;
  return compressed_size > most ? std::numeric_limits<std::uint64_t>::max() : compressed_size * ratio;
}

struct Decompressor::Contexts {
  Lz4Context lz4;
  ZstdContext zstd;

  std::size_t decompress(Compression compression, ByteView data, std::span<std::byte> to) {
    if (compression == Compression::kLz4) {
      if (!lz4) lz4 = lz4_context();
      return decompress_lz4(lz4.get(), data, to);
    }
    if (!zstd) zstd.reset(ZSTD_createDCtx());
    if (!zstd) throw std::bad_alloc();
    return checked_zstd(ZSTD_decompressDCtx(zstd.get(), to.data(), to.size(), data.data(), data.size()));
  }
};

Decompressor::Decompressor() : contexts_(std::make_unique<Contexts>()) {}
Decompressor::~Decompressor() = default;
Decompressor::Decompressor(Decompressor&&) noexcept = default;

std::optional<ByteView> Decompressor::operator()(Compression compression, ByteView data, std::uint64_t size,
                                                 Buffer& out, std::string& reason) {
  ByteView result = data;
  try {
    if (compression != Compression::kNone) {
      const std::span<std::byte> to = out.reset(size);
      result = to.first(contexts_->decompress(compression, data, to));
    }
  } catch (const std::runtime_error& error) {
    reason = error.what();
    return std::nullopt;
  }
  if (result.size() == size) return result;
  reason = "it holds " + std::to_string(result.size()) + " bytes, not the " + std::to_string(size) + " that it says";
  return std::nullopt;
}

}  // namespace rtd::mcap
