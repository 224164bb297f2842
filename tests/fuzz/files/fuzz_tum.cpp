// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed lists of a TUM folder: rgb.txt, depth.txt and groundtruth.txt, or associations.txt, with NUL between them.
/// No exception but SourceError and TrajectoryError; colour stamps of pairs rise, and poses are rigid and in order.
#include <fmt/format.h>
#include <algorithm>
#include <filesystem>

#include "common/camera/folder/frame_lists.hpp"
#include "common/camera/frame_source.hpp"
#include "common/geometry/pose_list.hpp"
#include "common/geometry/trajectory.hpp"
#include "common/msg/stamps.hpp"
#include "tests/fuzz/fuzz_loop.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::camera {
namespace {

struct Counted {
  std::uint64_t pairs = 0, poses = 0;
};

std::vector<std::string> seeds() {
  std::string color = "# color images\n# timestamp filename\n", depth = "# depth maps\n", truth = "# ground truth\n",
              pairs;
  for (int i = 0; i < 12; ++i) {
    const std::string stamp = "130503117" + std::to_string(i) + "." + std::to_string(100'000 + 33'333 * i);
    color += stamp + " rgb/" + stamp + ".png\n";
    depth += stamp + "9 depth/" + stamp + ".png\n";
    truth += stamp + " 1.3405 0.6266 1.6575 0.6574 0.6126 -0.2949 -0.3248\n";
    pairs += stamp + " rgb/" + stamp + ".png " + stamp + "8 depth/" + stamp + ".png\n";
  }
  return {color + '\0' + depth + '\0' + truth, pairs};
}

std::vector<std::string> words() {
  return {"nan ",
          "inf ",
          "-inf ",
          "1e300 ",
          "-9.3e9 ",
          "9.2e9 ",
          "-9.2e9 ",
          "9199999999.999999999 ",
          "0 ",
          "-0.5 ",
          "1e-300 ",
          "+",
          "0x10 ",
          "1305031170.1 ",
          "# ",
          "\n",
          "\r\n",
          "\t",
          " ",
          "a b c d e\n",
          "../../etc/passwd ",
          "9223372036854775807 ",
          "1. ",
          ". ",
          "0 0 0 0 ",
          "99999999999999999999999.5 ",
          "\xff",
          "\x1b[31m"};
}

/// The folder that the readers are given.
class Folder {
 public:
  const std::filesystem::path& path() const { return folder_.path(); }
  void fill(const std::string& input) const {
    std::vector<std::string> parts(1);
    for (const char letter : input) {
      if (letter != '\0') parts.back() += letter;
      if (letter == '\0' && parts.size() < 3) parts.emplace_back();
    }
    std::filesystem::remove(path() / "associations.txt");
    if (parts.size() == 1) {
      folder_.write("associations.txt", parts[0]);
      return;
    }
    folder_.write("rgb.txt", parts[0]);
    folder_.write("depth.txt", parts[1]);
    folder_.write("groundtruth.txt", parts.size() > 2 ? parts[2] : "");
  }

 private:
  rtd::test::TemporaryFolder folder_;
};

std::string check_pairs(const std::filesystem::path& folder, Counted& counted) {
  const PairList list = read_two_lists(folder, "rgb.txt", "depth.txt");
  counted.pairs += list.pairs.size();
  for (std::size_t i = 1; i < list.pairs.size(); ++i)
    if (list.pairs[i].color.stamp_ns <= list.pairs[i - 1].color.stamp_ns) return "colour stamps do not rise";
  return "";
}

std::string check_poses(const std::filesystem::path& file, Counted& counted) {
  geometry::Trajectory poses = geometry::read_pose_list(file).poses;
  counted.poses += poses.size();
  std::ranges::stable_sort(poses, {}, &geometry::StampedPose::stamp_ns);
  for (const geometry::StampedPose& pose : poses) {
    if (!pose.T_world_body.matrix().allFinite()) return "a pose is not finite";
    geometry::pose_at(poses, msg::plus_ns(pose.stamp_ns, 1), 1'000'000'000);
  }
  return "";
}

std::string try_input(const io::Bytes& input, const Folder& folder, Counted& counted) {
  folder.fill(fuzz::text_of(input));
  std::string failure;
  try {
    failure = check_pairs(folder.path(), counted);
  } catch (const SourceError&) {
  }
  try {
    if (failure.empty()) failure = check_poses(folder.path() / "groundtruth.txt", counted);
  } catch (const geometry::TrajectoryError&) {
  }
  return failure;
}

}  // namespace
}  // namespace rtd::camera

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<std::string> texts = camera::seeds(), all_words = camera::words();
  const camera::Folder folder;
  camera::Counted counted;
  return fuzz::run_fuzz(
      argc, argv,
      {.failed_path = "fuzz_tum_failed.txt",
       .make = [&](fuzz::Random& random) { return fuzz::mutate_text(texts, all_words, random); },
       .test = [&](const io::Bytes& input, fuzz::Random&) { return camera::try_input(input, folder, counted); },
       .counted = [&] { return fmt::format("{} pairs, {} poses", counted.pairs, counted.poses); }});
}
