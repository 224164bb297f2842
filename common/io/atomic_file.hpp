// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <iosfwd>
#include <string>
#include <string_view>

#include "common/io/byte_sink.hpp"
#include "common/io/fd_writing.hpp"

namespace rtd::io {

/// Who chose the name of a file. What the operator named on the command line may be a symbolic link, which is followed,
/// or a device or pipe, which is written as it is. At a name that a program chose, or that came over the network, both
/// are refused: another user may have put them there.
enum class NamedBy { kProgram, kOperator };

struct AtomicOptions {
  NamedBy named_by = NamedBy::kProgram;
  IfExists if_exists = IfExists::kReplace;
  unsigned mode = 0644;   ///< of a new file, less the umask
  bool keep_mode = true;  ///< a replaced file's permissions stay
  bool durable = true;    ///< survives a power cut from commit() on; off for one of thousands of files
};

/// A file that appears whole or not at all, and in one step takes the place of what had its name: written under a
/// random name next to it (O_EXCL), made durable and renamed by commit(). Without commit() nothing is left. For one
/// thread.
class AtomicFile final : public ByteSink {
 public:
  /// Throws IoError naming file, cause and fix: no such folder, read-only, a symbolic link, it exists (kFail), ...
  explicit AtomicFile(std::filesystem::path path, AtomicOptions options = {});
  ~AtomicFile() override;
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void append(std::initializer_list<ByteView> parts) override;
  std::uint64_t position() const override { return position_; }
  std::uint64_t sync() override;
  /// Makes the file durable and gives it its name. Throws IoError; what had the name keeps it then. Call it once.
  void commit();

 private:
  struct Earlier;
  void open_directly();
  void create_beside(const Earlier& earlier);
  bool try_create(unsigned mode);
  void give_name();
  bool is_direct() const { return beside_.empty() && !committed_; }

  const std::filesystem::path path_;
  const AtomicOptions options_;
  Descriptor folder_, file_;
  std::string name_;    ///< in the folder
  std::string beside_;  ///< the temporary name; empty: a device, or committed
  std::uint64_t position_ = 0;
  bool committed_ = false;
};

/// Writes a whole file as AtomicFile does. Throws IoError.
void write_file(const std::filesystem::path& path, ByteView content, AtomicOptions options = {});
inline void write_file(const std::filesystem::path& path, std::string_view content, AtomicOptions options = {}) {
  write_file(path, bytes_of(content), options);
}

/// The same with what `write` prints. Throws IoError and what `write` throws; the file is then as it was.
void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write,
                AtomicOptions options = {});

/// Removes what killed processes left unfinished in a folder: temporary files of AtomicFile that no process has open.
/// What cannot be removed stays.
void remove_unfinished(const std::filesystem::path& folder);

}  // namespace rtd::io
