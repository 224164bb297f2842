// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// A map file gives back the map that was written, and nothing else is taken for a map.
#include <gmock/gmock.h>

#include <random>

#include "common/io/bytes.hpp"
#include "tests/support/sample_map.hpp"
#include "tests/unit/slam/store/memory_map_file.hpp"

namespace rtd::slam {
namespace {

using test_support::sample_contents;
using test_support::sample_map;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// Why the bytes are no map; empty when they are one.
std::string format_refusal(io::ByteView bytes) {
  try {
    read_bytes(bytes);
    return {};
  } catch (const MapFileError& error) {
    return error.what();
  }
}

io::Bytes tiny_file() {
  return bytes_of_map(sample_map({.keyframes = 3, .features = 8, .seen_per_keyframe = 3, .new_per_keyframe = 2}));
}

TEST(MapFile, gives_the_same_map_back) {
  const Map map = sample_map({.keyframes = 30, .features = 100, .seen_per_keyframe = 40, .new_per_keyframe = 15});
  const io::Bytes bytes = bytes_of_map(map);
  const Map restored(read_bytes(bytes));
  EXPECT_EQ(restored.check_invariants(), "");
  EXPECT_EQ(bytes_of_map(restored), bytes);
  EXPECT_EQ(restored.keyframes().size(), map.keyframes().size());
  EXPECT_EQ(restored.landmark_ids(), map.landmark_ids());
  EXPECT_EQ(restored.keyframe_count(1), 1U);
  for (const auto& [id, keyframe] : map.keyframes()) {
    EXPECT_EQ(restored.find_keyframe(id)->covisible, keyframe.covisible);
    EXPECT_EQ(restored.find_keyframe(id)->children, keyframe.children);
    EXPECT_EQ(restored.find_keyframe(id)->T_world_camera.matrix(), keyframe.T_world_camera.matrix());
    EXPECT_EQ(restored.find_keyframe(id)->covariance, keyframe.covariance);
    EXPECT_EQ(restored.find_keyframe(id)->way_m, keyframe.way_m);
    EXPECT_EQ(restored.find_keyframe(id)->frame->readout_s, 0.02);
  }
  ASSERT_THAT(restored.loops(), SizeIs(1));
  EXPECT_EQ(restored.loops()[0].newer, 29U);
  EXPECT_EQ(restored.loops()[0].inliers, 80);
  EXPECT_EQ(restored.loops()[0].T_older_newer.matrix(), map.loops()[0].T_older_newer.matrix());
  EXPECT_EQ(restored.T_world_keyframe(2).matrix(), map.T_world_keyframe(2).matrix()) << "removed, but not forgotten";
}

TEST(MapFile, of_an_earlier_version_keeps_its_probabilities) {
  const Map map = sample_map();
  MapSnapshot snapshot = take_snapshot(map);
  snapshot.head.probability_origin = 1;
  const Map restored(read_bytes(bytes_of_map(snapshot)));
  for (const LandmarkId id : map.landmark_ids())
    ASSERT_EQ(restored.find_landmark(id)->static_probability, map.find_landmark(id)->static_probability);
}

TEST(MapFile, gives_features_a_grid_to_be_found_in) {
  const Map restored(read_bytes(bytes_of_map(sample_map())));
  const Frame& frame = *restored.keyframes().begin()->second.frame;
  const msg::Feature& feature = frame.features.front();
  vision::SearchWindow window;
  window.u_px = feature.u_px;
  window.v_px = feature.v_px;
  window.radius_px = 1;
  EXPECT_THAT(frame.grid.find(window), ::testing::Contains(0U));
}

TEST(MapFile, a_restored_map_continues_with_new_ids) {
  const Map map = sample_map();
  Map restored(read_bytes(bytes_of_map(map)));
  const KeyframeId next =
      restored.add_keyframe(map.find_keyframe(0)->frame, Eigen::Isometry3d::Identity(), kNoKeyframe);
  EXPECT_EQ(next, map.next_keyframe());
  EXPECT_EQ(restored.find_keyframe(next)->map, map.next_map());
  EXPECT_EQ(restored.add_landmark({0, 0, 1}, {next, 0}), map.next_landmark());
  restored.remove_keyframe(1);
  EXPECT_EQ(restored.check_invariants(), "");
}

TEST(MapFile, can_be_read_without_features) {
  const MapContents contents = read_bytes(bytes_of_map(sample_map()), StoredFeatures::kSkip);
  EXPECT_THAT(contents.keyframes.front().landmarks, SizeIs(40));
  EXPECT_THAT(contents.keyframes.front().frame->features, SizeIs(0));
  EXPECT_GT(contents.landmarks.front().observation_weight, 0);
}

TEST(MapFile, leaves_out_landmarks_without_a_finite_position) {
  Map map = sample_map();
  map.find_landmark(5)->position.x() = std::nan("");
  const Map restored(read_bytes(bytes_of_map(map)));
  EXPECT_EQ(restored.landmark_count() + 1, map.landmark_count());
  EXPECT_EQ(restored.check_invariants(), "");
}

TEST(MapFile, leaves_out_covariances_that_cannot_be) {
  Map map = sample_map();
  (*map.find_keyframe(1)->covariance)(0, 1) = 1;  // a correlation far beyond 1
  const Map restored(read_bytes(bytes_of_map(map)));
  EXPECT_FALSE(restored.find_keyframe(1)->covariance.has_value());
  EXPECT_TRUE(restored.find_keyframe(4)->covariance.has_value());
}

TEST(MapFile, is_not_written_with_a_pose_that_cannot_be_read) {
  Map map = sample_map();
  map.find_keyframe(1)->T_world_camera.translation().x() = std::nan("");
  EXPECT_THAT([&] { bytes_of_map(map); }, ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("keyframe 1")));
}

TEST(MapFile, cut_at_any_byte_is_refused) {
  const io::Bytes file = tiny_file();
  ASSERT_EQ(format_refusal(file), "");
  for (std::size_t size = 0; size < file.size(); ++size)
    ASSERT_NE(format_refusal(io::ByteView(file).first(size)), "") << "cut at byte " << size << " of " << file.size();
  EXPECT_THAT(format_refusal(io::ByteView(file).first(file.size() - 1)), HasSubstr("it was cut"));
  EXPECT_THAT(format_refusal({}), HasSubstr("the file is empty"));
}

TEST(MapFile, with_any_bit_flipped_is_refused) {
  io::Bytes file = tiny_file();
  for (std::size_t bit = 0; bit < 8 * file.size(); ++bit) {
    const std::byte mask = std::byte{1} << (bit % 8);
    file[bit / 8] ^= mask;
    ASSERT_NE(format_refusal(file), "") << "bit " << bit % 8 << " of byte " << bit / 8;
    file[bit / 8] ^= mask;
  }
}

TEST(MapFile, with_many_bits_flipped_is_refused) {
  const io::Bytes whole = bytes_of_map(sample_map());
  std::mt19937_64 random(3);
  for (int i = 0; i < 2000; ++i) {
    io::Bytes file = whole;
    for (std::uint64_t flips = 1 + random() % 20; flips > 0; --flips)
      file[random() % file.size()] ^= std::byte{1} << (random() % 8);
    if (file != whole) {
      ASSERT_NE(format_refusal(file), "") << "round " << i;
    }
  }
}

TEST(MapFile, with_something_behind_its_end_is_refused) {
  io::Bytes file = tiny_file();
  file.push_back(std::byte{0});
  EXPECT_THAT(format_refusal(file), HasSubstr("follows the end"));
}

io::Bytes file_of_version(std::uint32_t version) {
  io::Bytes file = tiny_file();
  io::store(file.data() + 8, version);
  io::store(file.data() + 12, io::crc32(io::ByteView(file).first(12)));
  return file;
}

TEST(MapFile, of_another_version_is_refused_naming_both) {
  EXPECT_THAT(format_refusal(file_of_version(3)),
              AllOf(HasSubstr("version 3"), HasSubstr("reads version 2"), HasSubstr("newer program")));
  EXPECT_THAT(format_refusal(file_of_version(1)),
              AllOf(HasSubstr("version 1"), HasSubstr("reads version 2"), HasSubstr("older program")));
}

TEST(MapFile, of_another_kind_is_refused) {
  const std::string text = "ply\nformat ascii 1.0\n";
  EXPECT_THAT(format_refusal(io::bytes_of(text)), HasSubstr("not a map file"));
}

/// A file whose checksums are right and whose contents are not.
struct Lie {
  const char* name;
  void (*fill)(MapSnapshot&);
  const char* refusal;
};
void PrintTo(const Lie& lie, std::ostream* out) {
  *out << lie.name;
}

template <class T>
void overwrite(io::Bytes& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

class LyingMapFile : public ::testing::TestWithParam<Lie> {};

TEST_P(LyingMapFile, is_refused_with_the_reason) {
  MapSnapshot snapshot = take_snapshot(sample_map());
  GetParam().fill(snapshot);
  EXPECT_THAT(format_refusal(bytes_of_map(snapshot)),
              AllOf(HasSubstr("damaged at byte"), HasSubstr(GetParam().refusal)));
}

constexpr std::size_t kPositionX = 4, kProbability = 4 + 8 * 8, kReference = 4 + 10 * 8 + 32;
const Lie kLies[] = {
    {"no_keyframe", [](MapSnapshot& s) { s.head.keyframes = 0; }, "holds no keyframe"},
    {"fewer_keyframes", [](MapSnapshot& s) { --s.head.keyframes; }, "more records than announced"},
    {"more_keyframes", [](MapSnapshot& s) { ++s.head.keyframes; }, "missing or in another order"},
    {"most_landmarks", [](MapSnapshot& s) { s.head.landmarks = 0xFFFFFFFF; }, "missing or in another order"},
    {"probability_origin", [](MapSnapshot& s) { s.head.probability_origin = 7; }, "unknown origin"},
    {"focal_length", [](MapSnapshot& s) { s.head.cameras[0].projection.fx = std::nan(""); }, "intrinsics"},
    {"image_size", [](MapSnapshot& s) { s.head.cameras[0].width_px = 2000000000; }, "intrinsics"},
    {"many_keyframe_ids", [](MapSnapshot& s) { s.head.next_keyframe = 0xFFFFFFF0; }, "far more memory"},
    {"camera", [](MapSnapshot& s) { s.keyframes[1].camera = 3; }, "unknown camera"},
    {"free_keyframe_id", [](MapSnapshot& s) { s.keyframes.back().id = 400; }, "still free"},
    {"free_landmark_id", [](MapSnapshot& s) { s.head.next_landmark = 4; }, "still free"},
    {"keyframe_order", [](MapSnapshot& s) { s.keyframes[1].id = 0; }, "behind a later one"},
    {"landmark_order", [](MapSnapshot& s) { overwrite(s.landmarks, 0, LandmarkId{2}); }, "behind a later one"},
    {"landmark_nan", [](MapSnapshot& s) { overwrite(s.landmarks, kPositionX, std::nan("")); }, "cannot be"},
    {"landmark_probability", [](MapSnapshot& s) { overwrite(s.landmarks, kProbability, 1.5); }, "cannot be"},
    {"landmark_reference", [](MapSnapshot& s) { overwrite(s.landmarks, kReference, KeyframeId{8}); },
     "not seen by its reference"},
    {"landmark_maker", [](MapSnapshot& s) { overwrite(s.landmarks, kReference + 4, KeyframeId{500}); }, "never was"},
    {"landmark_unseen",
     [](MapSnapshot& s) {
       for (MapSnapshot::Observation& o : s.observations) o.landmark = o.landmark == 0 ? 999999 : o.landmark;
     },
     "seen by no keyframe"},
    {"seen_twice", [](MapSnapshot& s) { s.observations[1].landmark = s.observations[0].landmark; },
     "observes a landmark twice"},
    {"same_feature", [](MapSnapshot& s) { s.observations[1].feature = s.observations[0].feature; },
     "impossible feature"},
    {"far_feature", [](MapSnapshot& s) { s.observations[0].feature = 4000; }, "impossible feature"},
    {"parent_gone", [](MapSnapshot& s) { s.keyframes[1].parent = 3; }, "has no parent"},
    {"parent_younger", [](MapSnapshot& s) { s.keyframes[1].parent = s.keyframes[2].id; }, "has no parent"},
    {"parent_itself", [](MapSnapshot& s) { s.keyframes[1].parent = s.keyframes[1].id; }, "has no parent"},
    {"parent_elsewhere", [](MapSnapshot& s) { s.keyframes[1].map = 1; }, "parent in another map"},
    {"map_never_was", [](MapSnapshot& s) { s.keyframes[1].map = 9; }, "map that never was"},
    {"second_origin", [](MapSnapshot& s) { s.keyframes[1].parent = kNoKeyframe; }, "second origin"},
    {"way", [](MapSnapshot& s) { s.keyframes[1].way_m = std::nan(""); }, "impossible way"},
    {"covariance", [](MapSnapshot& s) { (*s.keyframes[1].covariance)(0, 0) = -1; }, "impossible covariance"},
    {"loop_order", [](MapSnapshot& s) { overwrite(s.loops, 0, KeyframeId{50}); }, "ends at keyframes"},
    {"loop_never_was", [](MapSnapshot& s) { overwrite(s.loops, 4, KeyframeId{5000}); }, "ends at keyframes"},
    {"loop_pose", [](MapSnapshot& s) { overwrite(s.loops, 12, 2.0); }, "impossible pose"},
    {"more_loops", [](MapSnapshot& s) { ++s.head.loops; }, "missing or in another order"},
    {"readout",
     [](MapSnapshot& s) {
       auto frame = std::make_shared<Frame>();
       frame->features = s.keyframes[1].frame->features;
       frame->camera = s.keyframes[1].frame->camera;
       frame->readout_s = std::nan("");
       s.keyframes[1].frame = frame;
     },
     "impossible readout"},
    {"removed_order", [](MapSnapshot& s) { overwrite(s.removed, 0, KeyframeId{3}); }, "behind a later one"},
    {"removed_still_there", [](MapSnapshot& s) { overwrite(s.removed, 0, KeyframeId{1}); }, "still there"},
    {"removed_circle", [](MapSnapshot& s) { overwrite(s.removed, 4, KeyframeId{3}); }, "has no parent"},
    {"removed_pose", [](MapSnapshot& s) { overwrite(s.removed, 8, 2.0); }, "impossible pose"},
    {"feature_nan",
     [](MapSnapshot& s) {
       auto frame = std::make_shared<Frame>();
       frame->features = s.keyframes[1].frame->features;
       frame->features[3].depth_m = -1;
       s.keyframes[1].frame = frame;
     },
     "feature with values"},
    {"huge_images", [](MapSnapshot& s) { s.head.cameras[0].width_px = s.head.cameras[0].height_px = 16000; },
     "far more memory"},
};
INSTANTIATE_TEST_SUITE_P(Lies, LyingMapFile, ::testing::ValuesIn(kLies),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace rtd::slam
