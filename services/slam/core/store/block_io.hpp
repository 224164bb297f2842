// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/geometry/se3.hpp"
#include "common/io/byte_sink.hpp"
#include "common/io/byte_source.hpp"
#include "common/io/bytes.hpp"
#include "common/msg/features.hpp"
#include "common/ros_codec/byte_cursor.hpp"
#include "services/slam/core/store/map_format.hpp"

namespace rtd::slam::map_format {

/// Appends fields to a buffer.
class FieldWriter {
 public:
  explicit FieldWriter(io::Bytes& out) : out_(out) {}

  template <class... Fields>
  void operator()(const Fields&... fields) {
    (put(fields), ...);
  }

 private:
  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) { out_.insert(out_.end(), bytes(&value), bytes(&value) + sizeof(T)); }
  void put(const msg::Descriptor& value) { out_.insert(out_.end(), bytes(&value), bytes(&value) + value.size()); }
  void put(const Eigen::Vector3d& v) { (*this)(v.x(), v.y(), v.z()); }
  /// Its upper triangle, row by row.
  void put(const geometry::Matrix6d& symmetric) {
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column) put(symmetric(row, column));
    }
  }
  void put(const Eigen::Isometry3d& T) {
    for (int column = 0; column < 4; ++column) put(Eigen::Vector3d(T.matrix().col(column).head<3>()));
  }
  static const std::byte* bytes(const void* at) { return static_cast<const std::byte*>(at); }

  io::Bytes& out_;
};

/// Takes fields off the front of a view. Throws ros::WireError instead of reading past its end.
class FieldReader {
 public:
  explicit FieldReader(io::ByteView in) : cursor_({reinterpret_cast<const std::uint8_t*>(in.data()), in.size()}) {}

  std::size_t left() const { return cursor_.remaining(); }
  template <class... Fields>
  void operator()(Fields&... fields) {
    (get(fields), ...);
  }
  /// A part of the view, to be read on its own.
  FieldReader part(std::size_t size) { return FieldReader(std::as_bytes(cursor_.take(size))); }

 private:
  template <class T>
  requires std::is_arithmetic_v<T>
  void get(T& value) { value = cursor_.read<T>(); }
  void get(msg::Descriptor& value) { std::memcpy(value.data(), cursor_.take(value.size()).data(), value.size()); }
  void get(Eigen::Vector3d& v) { (*this)(v.x(), v.y(), v.z()); }
  void get(geometry::Matrix6d& symmetric) {
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column) {
        get(symmetric(row, column));
        symmetric(column, row) = symmetric(row, column);
      }
    }
  }
  void get(Eigen::Isometry3d& T) {
    for (int column = 0; column < 4; ++column) {
      Eigen::Vector3d v;
      get(v);
      T.matrix().col(column).head<3>() = v;
    }
  }

  ros::ByteCursor cursor_;
};

/// Writes preamble and blocks of a map file, each with its CRC. Throws io::IoError.
class BlockWriter {
 public:
  explicit BlockWriter(io::ByteSink& sink);
  void write(BlockTag tag, io::ByteView payload);
  /// The last block; a file without it is cut.
  void end();

 private:
  io::ByteSink& sink_;
  std::uint32_t blocks_ = 0;
};

struct Block {
  BlockTag tag{};
  std::uint64_t offset = 0;  ///< in the file
  io::ByteView payload;      ///< valid until the next one is read
};

/// Reads them back, one block in memory at a time. Throws MapFileError for everything that is not as it was written.
class BlockReader {
 public:
  explicit BlockReader(const io::ByteSource& source);
  /// The next block, its checksum compared.
  Block next();
  /// `last` must be the end block, and nothing may follow.
  void check_end(const Block& last) const;
  std::uint64_t position() const { return position_; }
  std::uint64_t size() const { return source_.size(); }

 private:
  io::ByteView read(std::size_t size, const char* what);

  const io::ByteSource& source_;
  io::Bytes buffer_;
  std::uint64_t position_ = 0;
  std::uint32_t blocks_ = 0;
};

/// A damaged file, with the place.
[[noreturn]] void fail_damaged(std::uint64_t offset, const std::string& cause);

}  // namespace rtd::slam::map_format
