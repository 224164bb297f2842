// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recordings/open.hpp"

#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <utility>

#include "common/io/byte_sink.hpp"
#include "common/io/unpacked.hpp"
#include "common/mcap/copy.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/import.hpp"
#include "common/recordings/parts.hpp"
#include "common/recordings/reader.hpp"

namespace rtd::recordings {
namespace fs = std::filesystem;
namespace {

using mcap::RecordingFileError;

/// A file of its own in the folder for temporary files (TMPDIR), removed with this object: what has it open then keeps
/// its content.
class TemporaryFile {
 public:
  TemporaryFile() {
    std::string name = (fs::temp_directory_path() / "rtd_recording_XXXXXX").string();
    const int descriptor = mkstemp(name.data());
    if (descriptor < 0) throw io::IoError(errno, name + " cannot be made (TMPDIR names another folder)");
    close(descriptor);
    path_ = name;
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct FreeStream {
  void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
};

std::uint64_t room_at(const fs::path& file) {
  std::error_code none;
  const fs::space_info space = fs::space(file.parent_path(), none);
  return none ? UINT64_MAX : space.available / 10 * 9;
}

/// Appends what the zstd frames in `source` hold, up to what its size allows. At most nine tenths of the space that is
/// free where `sink` is are filled. Throws io::IoError (disk, no room). Returns what is damaged; empty for a whole
/// file.
std::string unpack(const io::ByteSource& source, io::FileSink& sink, const Progress& progress) {
  const std::unique_ptr<ZSTD_DStream, FreeStream> stream(ZSTD_createDStream());
  std::vector<std::byte> in(ZSTD_DStreamInSize()), out(ZSTD_DStreamOutSize());
  const std::uint64_t room = room_at(sink.path());
  io::UnpackLimit limit(source.size());
  std::size_t unfinished = 1;  // zstd's hint: 0 at the end of a frame
  std::uint64_t offset = 0;
  while (const std::size_t count = source.read(offset, in)) {
    ZSTD_inBuffer input{in.data(), count, 0};
    while (input.pos < input.size) {
      ZSTD_outBuffer output{out.data(), out.size(), 0};
      unfinished = ZSTD_decompressStream(stream.get(), &output, &input);
      if (ZSTD_isError(unfinished) != 0) {
        return std::string("damaged near byte ") + std::to_string(offset + input.pos) + ": " +
               ZSTD_getErrorName(unfinished) + "; what follows is lost";
      }
      if (!limit.take(output.pos)) return "it unpacks to too much for its size; what follows is lost";
      if (sink.position() + output.pos > room) throw io::IoError(ENOSPC, "unpacked it takes more room than is free");
      sink.append({io::ByteView(out).first(output.pos)});
    }
    offset += count;
    progress(offset);
  }
  return unfinished == 0 ? std::string() : "it ends within a zstd frame; what follows is lost";
}

/// A file of the recording as it lies there, or unpacked.
struct Plain {
  std::unique_ptr<TemporaryFile> unpacked;
  fs::path path;
  Form form{};
};

/// Maps the two passes over the files, unpacking and importing, to bytes of them all.
class Passes {
 public:
  Passes(const Parts& parts, const Progress& progress) : progress_(progress) {
    for (const fs::path& file : parts.files) {
      const io::FileSource source(file);
      forms_.push_back(form_of(source));
      sizes_.push_back(source.size());
    }
    packed_ = std::ranges::count(forms_, Form::kPacked) > 0;
  }
  bool packed() const { return packed_; }
  Form form(std::size_t file) const { return forms_[file]; }
  void unpacked(std::size_t file, std::uint64_t bytes) const { progress_((before(file) + bytes) / 2); }
  void imported(std::size_t file, double share) const {
    const std::uint64_t done = before(file) + static_cast<std::uint64_t>(share * static_cast<double>(sizes_[file]));
    progress_(packed_ ? (before(sizes_.size()) + done) / 2 : done);
  }

 private:
  std::uint64_t before(std::size_t file) const {
    return std::accumulate(sizes_.begin(), sizes_.begin() + static_cast<std::ptrdiff_t>(file), std::uint64_t{0});
  }

  const Progress& progress_;
  std::vector<Form> forms_;
  std::vector<std::uint64_t> sizes_;
  bool packed_ = false;
};

Plain plain_file(const fs::path& file, Form form, Opened& opened, const Progress& progress) {
  if (form != Form::kPacked) return {nullptr, file, form};
  Plain plain{std::make_unique<TemporaryFile>(), {}, {}};
  plain.path = plain.unpacked->path();
  io::FileSink sink(plain.path, io::IfExists::kReplace);
  const std::string damage = unpack(io::FileSource(file), sink, progress);
  if (!damage.empty()) opened.damages.push_back(file.string() + ": " + damage);
  plain.form = form_of(io::FileSource(plain.path));
  return plain;
}

std::string description_of(const Parts& parts, bool packed) {
  std::string text = parts.files.size() == 1 ? "1 file" : std::to_string(parts.files.size()) + " files";
  text += " copied into MCAP";
  return packed || parts.packed_messages ? text + ", unpacked from zstd" : text;
}

/// Attachments and metadata stay, which import() would leave out.
void join(const std::vector<Plain>& files, io::ByteSink& sink, Opened& opened) {
  std::vector<std::unique_ptr<io::FileSource>> sources;
  std::vector<const io::ByteSource*> parts;
  for (const Plain& file : files) {
    parts.push_back(sources.emplace_back(std::make_unique<io::FileSource>(file.path)).get());
  }
  const mcap::CopyReport report = mcap::join(parts, sink);
  for (const mcap::Problem& problem : report.problems) {
    if (mcap::is_damage(problem)) opened.damages.push_back(mcap::to_string(problem));
  }
}

void import(const Parts& parts, const std::vector<Plain>& files, io::ByteSink& sink, Opened& opened,
            const Passes& passes) {
  Import importing(sink, parts.packed_messages);
  for (std::size_t i = 0; i < files.size(); ++i) {
    importing.add(files[i].path, files[i].form, parts.files[i].string(),
                  [&](double share) { passes.imported(i, share); });
  }
  importing.close();
  for (const std::string& damage : importing.damages()) opened.damages.push_back(damage);
}

Opened open_parts(const Parts& parts, const Progress& progress) {
  Opened opened;
  for (const std::string& missing : parts.missing) opened.damages.push_back(missing + " is missing; it is left out");
  const Passes passes(parts, progress);
  std::vector<Plain> files;
  bool all_mcap = true;
  for (std::size_t i = 0; i < parts.files.size(); ++i) {
    files.push_back(
        plain_file(parts.files[i], passes.form(i), opened, [&](std::uint64_t bytes) { passes.unpacked(i, bytes); }));
    all_mcap = all_mcap && files.back().form == Form::kMcap;
  }
  opened.imported = description_of(parts, passes.packed());
  if (all_mcap && files.size() == 1 && !parts.packed_messages) {
    opened.imported = passes.packed() ? "unpacked from zstd" : "";
    opened.source = std::make_unique<io::FileSource>(files.front().path);
    return opened;
  }
  const TemporaryFile copy;
  io::FileSink sink(copy.path(), io::IfExists::kReplace);
  if (all_mcap && !parts.packed_messages) {
    join(files, sink, opened);
  } else {
    import(parts, files, sink, opened, passes);
  }
  opened.source = std::make_unique<io::FileSource>(copy.path());
  return opened;
}

}  // namespace

std::uint64_t size_of(const std::string& path) {
  std::uint64_t bytes = 0;
  for (const fs::path& file : parts_of(path).files) {
    std::error_code none;
    const std::uint64_t size = fs::file_size(file, none);
    bytes += none ? 0 : size;
  }
  return bytes;
}

Opened open(const std::string& path, const Progress& progress) {
  const Parts parts = parts_of(path);
  try {
    return open_parts(parts, progress);
  } catch (const io::IoError& error) {
    if (error.code().value() != ENOSPC) throw RecordingFileError(error.what());
    throw RecordingFileError(path + ": no room to copy it into an MCAP file in " + fs::temp_directory_path().string() +
                             ": let TMPDIR name a folder with more");
  }
}

bool is_recording(const std::string& path) {
  if (std::error_code error; fs::is_directory(path, error)) return true;
  try {
    return form_of(io::FileSource(path)) != Form::kOther;
  } catch (const io::IoError& error) {
    throw RecordingFileError(error.what());
  }
}

}  // namespace rtd::recordings
