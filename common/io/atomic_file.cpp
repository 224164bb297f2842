// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <ostream>
#include <streambuf>
#include <utility>

namespace rtd::io {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kHead = ".rtd-", kTail = ".tmp";
constexpr std::size_t kRandomDigits = 16;

std::string temporary_name(const fs::path& path) {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != static_cast<ssize_t>(sizeof number)) fail_writing(path, EIO);
  std::array<char, kRandomDigits + 1> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(number));
  return std::string(kHead) + digits.data() + std::string(kTail);
}

bool is_temporary(std::string_view name) {
  if (name.size() != kHead.size() + kRandomDigits + kTail.size() || !name.starts_with(kHead) || !name.ends_with(kTail))
    return false;
  return name.substr(kHead.size(), kRandomDigits).find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// A pipe, a device or another open file of this process (/dev/stdout): nothing that a rename could replace.
bool is_written_directly(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) return true;
  const std::string text = path.string();
  return text == "/dev/stdout" || text == "/dev/stderr" || text.starts_with("/dev/fd/") || text.starts_with("/proc/");
}

/// Where the links of the last part of a path lead.
fs::path follow_links(fs::path path) {
  constexpr int kMaxLinks = 40;  // as the kernel
  std::error_code error;
  for (int i = 0; i < kMaxLinks && fs::is_symlink(fs::symlink_status(path, error)); ++i) {
    const fs::path target = fs::read_symlink(path, error);
    if (error) fail_writing(path, error.value());
    path = path.parent_path() / target;  // an absolute target replaces all
  }
  return path;
}

/// Text for a sink, in blocks.
class SinkBuffer final : public std::streambuf {
 public:
  explicit SinkBuffer(ByteSink& sink) : sink_(sink) { setp(block_.data(), block_.data() + block_.size()); }

 protected:
  int_type overflow(int_type next) override {
    sync();
    if (!traits_type::eq_int_type(next, traits_type::eof())) sputc(traits_type::to_char_type(next));
    return traits_type::not_eof(next);
  }
  int sync() override {
    sink_.append({bytes_of({pbase(), static_cast<std::size_t>(pptr() - pbase())})});
    setp(block_.data(), block_.data() + block_.size());
    return 0;
  }

 private:
  ByteSink& sink_;
  std::array<char, 65536> block_{};
};

}  // namespace

/// What has the name now.
struct AtomicFile::Earlier {
  bool exists = false;
  unsigned mode = 0;

  static Earlier at(int folder, const std::string& name, const fs::path& path) {
    struct stat status {};
    if (::fstatat(folder, name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0) {
      if (errno != ENOENT) fail_writing(path, errno);
      return {};
    }
    if (S_ISLNK(status.st_mode)) fail_writing(path, ELOOP);
    if (S_ISDIR(status.st_mode)) fail_writing(path, EISDIR);
    if (!S_ISREG(status.st_mode)) fail_writing(path, ENOTSUP);
    return {true, status.st_mode & 0777U};
  }
};

AtomicFile::AtomicFile(fs::path path, AtomicOptions options)
    : path_(options.named_by == NamedBy::kOperator && !is_written_directly(path) ? follow_links(std::move(path))
                                                                                  : std::move(path)),
      options_(options) {
  if (options_.named_by == NamedBy::kOperator && is_written_directly(path_)) {
    open_directly();
    return;
  }
  name_ = path_.filename().string();
  if (name_.empty() || name_ == "." || name_ == "..") fail_writing(path_, EISDIR);
  folder_.reset(open_folder_of(path_));
  const Earlier earlier = Earlier::at(folder_.get(), name_, path_);
  if (earlier.exists && options_.if_exists == IfExists::kFail) fail_writing(path_, EEXIST);
  create_beside(earlier);
}

AtomicFile::~AtomicFile() {
  if (!beside_.empty()) ::unlinkat(folder_.get(), beside_.c_str(), 0);
}

void AtomicFile::open_directly() {
  file_.reset(::open(path_.c_str(), O_WRONLY | O_TRUNC | O_NOCTTY | O_CLOEXEC));
  if (file_.get() < 0) fail_writing(path_, errno);
}

void AtomicFile::create_beside(const Earlier& earlier) {
  constexpr int kTries = 10;
  for (int i = 0; i < kTries; ++i) {
    if (!try_create(options_.mode)) continue;
    if (earlier.exists && options_.keep_mode) ::fchmod(file_.get(), earlier.mode);  // else that of a new file
    return;
  }
  fail_writing(path_, EAGAIN);
}

/// Locked, so that remove_unfinished() sees that it is in use. False: the name is taken, or was cleaned up meanwhile.
bool AtomicFile::try_create(unsigned mode) {
  const std::string name = temporary_name(path_);
  const int fd = ::openat(folder_.get(), name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
  if (fd < 0 && errno == EEXIST) return false;
  if (fd < 0) fail_writing(path_, errno);
  file_.reset(fd);
  struct stat status {};
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
  if (::fstat(fd, &status) != 0 || status.st_nlink == 0) return false;
  beside_ = name;
  return true;
}

void AtomicFile::append(std::initializer_list<ByteView> parts) {
  if (const int error_number = write_parts(file_.get(), parts); error_number != 0) fail_writing(path_, error_number);
  position_ += size_of(parts);
}

std::uint64_t AtomicFile::sync() {
  // A pipe or a device has nothing to sync.
  if (::fdatasync(file_.get()) != 0 && !is_direct()) fail_writing(path_, errno);
  return position_;
}

void AtomicFile::commit() {
  if (options_.durable) sync();
  if (is_direct()) return;
  give_name();
  beside_.clear();
  committed_ = true;
  file_.reset();
  if (options_.durable) sync_folder(folder_.get(), folder_of(path_));
}

void AtomicFile::give_name() {
  const int folder = folder_.get();
  const unsigned flags = options_.if_exists == IfExists::kFail ? RENAME_NOREPLACE : 0U;
  if (::renameat2(folder, beside_.c_str(), folder, name_.c_str(), flags) == 0) return;
  // Some file systems know no flags; a file that has come meanwhile is then replaced.
  if (errno == EINVAL && ::renameat(folder, beside_.c_str(), folder, name_.c_str()) == 0) return;
  fail_writing(path_, errno);
}

void write_file(const fs::path& path, ByteView content, AtomicOptions options) {
  AtomicFile file(path, options);
  file.append({content});
  file.commit();
}

void write_file(const fs::path& path, const std::function<void(std::ostream&)>& write, AtomicOptions options) {
  AtomicFile file(path, options);
  SinkBuffer buffer(file);
  std::ostream out(&buffer);
  out.exceptions(std::ios::badbit);  // what the sink throws comes through
  write(out);
  out.flush();
  file.commit();
}

void remove_unfinished(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
    if (!is_temporary(entry.path().filename().string())) continue;
    const Descriptor file(::open(entry.path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    struct stat status {};
    if (file.get() < 0 || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    if (status.st_uid == ::geteuid() && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0) ::unlink(entry.path().c_str());
  }
}

}  // namespace rtd::io
