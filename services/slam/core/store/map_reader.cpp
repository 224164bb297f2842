// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/store/map_reader.hpp"

#include "services/slam/core/store/block_io.hpp"
#include "services/slam/core/store/contents_builder.hpp"

namespace rtd::slam {
namespace {

using namespace map_format;

class MapReader {
 public:
  MapReader(const io::ByteSource& source, const MapReadOptions& options) : options_(options), blocks_(source) {}

  MapContents read() {
    const Head head = read_head();
    ContentsBuilder builder = located([&] { return ContentsBuilder(head, options_.features, blocks_.size()); });
    read_records(BlockTag::kLandmarks, head.landmarks, [&](FieldReader& fields) { builder.add_landmark(fields); });
    read_records(BlockTag::kKeyframes, head.keyframes, [&](FieldReader& fields) { builder.add_keyframe(fields); });
    read_records(BlockTag::kRemoved, head.removed, [&](FieldReader& fields) { builder.add_removed(fields); });
    block_ = blocks_.next();
    return located([&] {
      blocks_.check_end(block_);
      return builder.finish();
    });
  }

 private:
  Head read_head() {
    expect(BlockTag::kHead);
    return located([&] { return map_format::read_head(FieldReader(block_.payload)); });
  }

  /// `count` records in as many blocks as they take.
  template <class ReadRecord>
  void read_records(BlockTag tag, std::uint32_t count, ReadRecord read_record) {
    for (std::uint32_t done = 0; done < count;) {
      expect(tag);
      FieldReader fields(block_.payload);
      located([&] {
        for (; done < count && fields.left() > 0; ++done) read_record(fields);
        if (fields.left() > 0) throw Unsound("more records than announced");
      });
    }
  }

  void expect(BlockTag tag) {
    block_ = blocks_.next();
    if (block_.tag != tag) fail_damaged(block_.offset, "blocks are missing or in another order");
    if (block_.payload.empty()) fail_damaged(block_.offset, "an empty block");
    if (options_.on_progress) options_.on_progress(blocks_.position());
  }

  /// What is wrong with a record, with its place.
  template <class Step>
  std::invoke_result_t<Step> located(Step step) {
    try {
      return step();
    } catch (const Unsound& error) {
      fail_damaged(block_.offset, error.what());
    } catch (const ros::WireError& error) {
      fail_damaged(block_.offset, error.what());
    }
  }

  const MapReadOptions& options_;
  BlockReader blocks_;
  Block block_;
};

}  // namespace

MapContents read_map(const io::ByteSource& source, const MapReadOptions& options) {
  return MapReader(source, options).read();
}

}  // namespace rtd::slam
