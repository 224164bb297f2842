// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/payload_layout.hpp"

#include <algorithm>

#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/tracking.hpp"
#include "services/recorder/inspect/payload_cursor.hpp"

namespace rtd::recording {
namespace {

using enum FieldKind;

const std::vector<Field> kHeader = {
    {"header.stamp.sec", kI32}, {"header.stamp.nanosec", kU32}, {"header.frame_id", kText}};

FieldGroup with_header(std::vector<Field> fields) {
  fields.insert(fields.begin(), kHeader.begin(), kHeader.end());
  return {std::move(fields)};
}

/// The order of common/msg and of the IDL files.
const std::vector<PayloadLayout> kLayouts = {
    {"RgbdFrame",
     {{{{"seq", kU64},
        {"stamp_ns", kI64},
        {"published_ns", kI64, 1, true},
        {"intrinsics", kF64, 4},
        {"distortion", kF64, 5},
        {"depth_scale_m", kF64},
        {"width", kU32},
        {"height", kU32},
        {"source_id", kU64, 1, true},
        {"color_bgr", kU8, msg::kMaxFramePixels * 3},
        {"depth", kU16, msg::kMaxFramePixels}}}}},
    {"FeatureFrame",
     {{{{"seq", kU64},
        {"stamp_ns", kI64},
        {"published_ns", kI64, 1, true},
        {"intrinsics", kF64, 4},
        {"width", kU32},
        {"height", kU32},
        {"count", kU32},
        {"removed", kU32},
        {"objects", kU32},
        {"detection_use", kU32},
        {"stage_ms", kF32, msg::kFilterStages, true}}},
      {{{"features.u_px", kF32},
        {"features.v_px", kF32},
        {"features.u_raw_px", kF32},
        {"features.v_raw_px", kF32},
        {"features.depth_m", kF32},
        {"features.angle_rad", kF32},
        {"features.static_probability", kF32},
        {"features.octave", kU8},
        {"features.flags", kU8},
        {"features.object_id", kI16},
        {"features.descriptor", kU8, 32}},
       msg::kMaxFeatures}}},
    {"TrackingResult",
     {{{{"seq", kU64},
        {"stamp_ns", kI64},
        {"published_ns", kI64, 1, true},
        {"finished_ns", kI64, 1, true},
        {"translation_m", kF64, 3},
        {"rotation_xyzw", kF64, 4},
        {"covariance", kF64, 36},
        {"event_count", kU64},
        {"state", kU32},
        {"inliers", kU32},
        {"features_static", kU32},
        {"features_removed", kU32},
        {"keyframes", kU32},
        {"landmarks", kU32},
        {"map_id", kU32},
        {"maps", kU32},
        {"stage_ms", kF32, msg::kSlamStages, true}}}}},
    {"KeyframeEvent",
     {{{{"event_index", kU64},
        {"frame_seq", kU64},
        {"stamp_ns", kI64},
        {"translation_m", kF64, 3},
        {"rotation_xyzw", kF64, 4},
        {"keyframe_id", kU32},
        {"kind", kU32}}}}},
    {"Odometry",
     {with_header({{"child_frame_id", kText},
                   {"pose.position", kF64, 3},
                   {"pose.orientation", kF64, 4},
                   {"pose.covariance", kF64, 36},
                   {"twist.linear", kF64, 3},
                   {"twist.angular", kF64, 3},
                   {"twist.covariance", kF64, 36}})}},
    {"PoseStamped", {with_header({{"position", kF64, 3}, {"orientation", kF64, 4}})}},
};

std::string bare_name(const std::string& type) {
  const std::size_t from = type.find_last_of("/:");
  std::string name = from == std::string::npos ? type : type.substr(from + 1);
  if (name.ends_with('_')) name.pop_back();
  return name;
}

/// The values of one field, over all its places in the message.
struct FieldDifference {
  std::size_t values = 0;
  std::string first;
};

std::string place(const Field& field, const FieldGroup& group, std::size_t repetition, std::size_t element) {
  std::string text;
  if (group.repeat > 1) text += "[" + std::to_string(repetition) + "]";
  if (field.count > 1) text += "[" + std::to_string(element) + "]";
  return text;
}

/// Compares the same group of both payloads; false where one of them ends.
bool compare(const FieldGroup& group, PayloadCursor& a, PayloadCursor& b, std::vector<FieldDifference>& found) {
  for (std::size_t repetition = 0; repetition < group.repeat; ++repetition)
    for (std::size_t f = 0; f < group.fields.size(); ++f)
      for (std::size_t element = 0; element < group.fields[f].count; ++element) {
        const mcap::ByteView value_a = a.take(group.fields[f].kind), value_b = b.take(group.fields[f].kind);
        if (!a.ok() || !b.ok()) return false;
        if (std::ranges::equal(value_a, value_b)) continue;
        if (found[f].values++ == 0)
          found[f].first = place(group.fields[f], group, repetition, element) + " " +
                           value_text(group.fields[f].kind, value_a) + " | " +
                           value_text(group.fields[f].kind, value_b);
      }
  return true;
}

std::vector<std::string> first_byte(mcap::ByteView a, mcap::ByteView b) {
  std::vector<std::string> lines;
  if (a.size() != b.size())
    lines.push_back("size: " + std::to_string(a.size()) + " | " + std::to_string(b.size()) + " bytes");
  const auto at = std::ranges::mismatch(a, b);
  if (at.in1 != a.end() && at.in2 != b.end())
    lines.push_back("first at byte " + std::to_string(at.in1 - a.begin()) + " of the payload");
  return lines;
}

}  // namespace

const PayloadLayout* layout_of(const std::string& type) {
  const auto known =
      std::ranges::find(kLayouts, bare_name(type), [](const PayloadLayout& l) { return std::string(l.type); });
  return known == kLayouts.end() ? nullptr : &*known;
}

std::vector<ByteRange> run_ranges(const PayloadLayout& layout) {
  std::vector<ByteRange> ranges;
  std::size_t offset = PayloadCursor::kHeaderBytes;
  for (const Field& field : layout.groups.front().fields) {
    if (field.kind == kText) break;
    const std::size_t size = size_of(field.kind);
    const std::size_t begin = offset + PayloadCursor::padding(offset, size);
    offset = begin + size * field.count;
    if (field.of_the_run) ranges.push_back({begin, offset});
  }
  return ranges;
}

std::vector<std::string> differences(const PayloadLayout* layout, mcap::ByteView a, mcap::ByteView b) {
  if (layout == nullptr) return first_byte(a, b);
  PayloadCursor cursor_a(a), cursor_b(b);
  std::vector<std::string> lines;
  for (const FieldGroup& group : layout->groups) {
    std::vector<FieldDifference> found(group.fields.size());
    const bool whole = compare(group, cursor_a, cursor_b, found);
    for (std::size_t f = 0; f < found.size(); ++f) {
      if (found[f].values == 0) continue;
      const std::string values = found[f].values > 1 ? ": " + std::to_string(found[f].values) + " values, first" : ":";
      lines.push_back(std::string(group.fields[f].name) + values + found[f].first +
                      (group.fields[f].of_the_run ? " (of the run)" : ""));
    }
    if (!whole) lines.emplace_back("one of them is too short for its type");
    if (!whole) break;
  }
  return lines.empty() ? first_byte(a, b) : lines;
}

}  // namespace rtd::recording
