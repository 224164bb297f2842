// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rtd::io {

/// A name that a command may not use, or a file that it may not have; what() is for the answer of the command: cause
/// and fix, and nothing about files that are not in the folder.
class NameError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A kind of file that commands may name.
struct FileKind {
  std::string_view what;       ///< "map"
  std::string_view extension;  ///< ".rtdmap"; added where a name lacks it
  std::string_view magic;      ///< how each such file begins
  std::string_view option;     ///< that names the folder: "--maps-dir"
};

/// The files that commands from the bus or from a page may name: of one kind, in one folder that the operator chose.
/// A command gives a name, never a path. Immutable.
class NamedFiles {
 public:
  /// `folder` "": there is none, every name is refused. It need not exist yet.
  NamedFiles(std::filesystem::path folder, FileKind kind) : folder_(std::move(folder)), kind_(kind) {}

  const std::filesystem::path& folder() const { return folder_; }
  /// The file of a name; whether it exists is not looked at. Throws NameError: letters, digits, '-', '_' and '.' only,
  /// no '.' or '-' first, 100 characters at most.
  std::filesystem::path path(const std::string& name) const;
  /// The same for a file to be written. Throws NameError also when the name belongs to something that is not a file of
  /// this kind. An empty file counts as one.
  std::filesystem::path to_write(const std::string& name) const;
  /// The same for a file to be read. Throws NameError: one text whether it is missing, a link, of another kind or not
  /// readable.
  std::filesystem::path to_read(const std::string& name) const;

 private:
  std::filesystem::path folder_;
  FileKind kind_;
};

/// What is at a path, links not followed.
enum class Found { kNothing, kOfThisKind, kEmpty, kOther };
Found look_at(const std::filesystem::path& path, std::string_view magic);

}  // namespace rtd::io
