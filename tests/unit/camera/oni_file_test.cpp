// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/openni2/oni_file.hpp"

#include <gmock/gmock.h>

#include <sstream>

#include "tests/support/oni_writer.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::camera {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::size_t kFirstRecord = 24, kFields = 12, kPayload = 16;

class OniFile : public ::testing::Test {
 protected:
  OniFile() {
    const rtd::test::TemporaryFolder folder;
    const std::string path = folder.file("walk.oni");
    {
      rtd::test::OniWriter writer(path, {8, 6}, 30);
      writer.color(0, cv::Mat::zeros(6, 8, CV_8UC3));
      writer.depth(0, cv::Mat::zeros(6, 8, CV_16UC1));
    }
    require_oni_file(path);
    bytes_ = rtd::test::read_text(path);
  }

  void set(std::size_t at, std::uint32_t value) {
    bytes_.replace(at, sizeof(value), reinterpret_cast<const char*>(&value), sizeof(value));
  }
  OniCheck check() const {
    std::istringstream file(bytes_);
    return check_oni(file, "walk.oni");
  }
  void refuses(const std::string& cause) const {
    EXPECT_THAT([&] { check(); }, ThrowsMessage<OniFileError>(AllOf(HasSubstr("walk.oni is not an .oni file"),
                                                                    HasSubstr("byte "), HasSubstr(cause))));
  }

  std::string bytes_;
};

TEST_F(OniFile, that_is_complete_passes_with_its_records) {
  const OniCheck found = check();
  EXPECT_EQ(found.frames, 2U);
  EXPECT_EQ(found.records, 2 * 7 + 4 + 2 + 1U);
  EXPECT_FALSE(found.cut);
}

TEST_F(OniFile, that_is_cut_in_an_image_passes_without_it) {
  bytes_.resize(bytes_.size() - 28 - 50);
  const OniCheck found = check();
  EXPECT_EQ(found.frames, 1U);
  EXPECT_TRUE(found.cut);
}

TEST_F(OniFile, of_another_format_is_refused) {
  bytes_[0] = 'X';
  refuses("does not begin with NI10");
  bytes_ = "NI10";
  refuses("a header of 24 bytes is expected, the file has 4");
}

TEST_F(OniFile, of_another_version_is_refused) {
  bytes_[4] = 2;
  refuses("version 2.0, only 1.x");
}

TEST_F(OniFile, with_records_of_false_size_is_refused_with_their_place) {
  set(kFirstRecord + kFields, 0xffffffff);
  refuses("byte 24: the fields of a record claim 4294967295 bytes");
  set(kFirstRecord + kFields, 27);
  refuses("claim 27 bytes");
  set(kFirstRecord + kFields, 5'000'000);
  refuses("a record claims 5000000 bytes, the file has");
}

TEST_F(OniFile, whose_chain_of_records_breaks_is_refused) {
  set(kFirstRecord + kPayload, 3);
  refuses("it has another magic");
}

TEST_F(OniFile, with_an_image_larger_than_the_library_holds_is_refused) {
  set(kFirstRecord + 4, 10);
  set(kFirstRecord + kPayload, 1600 * 1200 * 3 + 1);
  refuses("an image claims 5760001 bytes");
}

TEST_F(OniFile, without_records_is_refused) {
  bytes_.resize(kFirstRecord);
  refuses("no complete record");
}

}  // namespace
}  // namespace rtd::camera
