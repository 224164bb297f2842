// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "common/io/bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::fuzz {

using Random = std::mt19937_64;

io::Bytes bytes_of(std::string_view text);
std::string text_of(const io::Bytes& bytes);

/// A changed copy: bits, bytes, integers that programs get wrong, blocks moved, repeated or cut, and `other` spliced
/// in.
io::Bytes mutate(const io::Bytes& file, const io::Bytes& other, Random& random);
/// One of the files, changed.
io::Bytes mutate_one(const std::vector<io::Bytes>& files, Random& random);
/// Changes bytes, or puts words of a language into its texts: between lines, into them, or in place of something.
io::Bytes mutate_text(const std::vector<std::string>& texts, const std::vector<std::string>& words, Random& random);

/// A fuzz driver, `DRIVER [INPUTS [SEED]]`. An input is a failure when `test` says why or throws, when it makes the
/// process hold more memory than allowed (in builds with AddressSanitizer) or takes longer.
struct FuzzDriver {
  const char* failed_path;  ///< where the first failure is written
  std::function<io::Bytes(Random&)> make;
  std::function<std::string(const io::Bytes&, Random&)> test;
  std::function<std::string()> counted;  ///< what is said at the end
  std::size_t max_allocated = 64 << 20, max_allocated_per_byte = 0;
  double max_cpu_s = 0;  ///< 0: not measured
};

/// Exit code 1 and the input in `failed_path` at the first failure.
int run_fuzz(int argc, char** argv, const FuzzDriver& driver);

/// The input of a reader of files, removed at the end.
class FuzzFile {
 public:
  explicit FuzzFile(const std::string& extension) : path_(folder_ / ("input" + extension)) {}
  const std::filesystem::path& path() const { return path_; }
  void write(const io::Bytes& bytes) const;

 private:
  test::TemporaryFolder folder_;
  std::filesystem::path path_;
};

}  // namespace rtd::fuzz
