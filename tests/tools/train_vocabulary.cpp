// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// rtd-train-vocabulary OUT [SOURCE...]: trains the vocabulary of place recognition on the ORB features of image sources
// (URIs as rtd-camera takes them). Without sources: our own rendered rooms, which is what the build does.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "common/camera/open/source_factory.hpp"
#include "common/io/atomic_file.hpp"
#include "services/filter/core/orb/orb_extractor.hpp"
#include "tests/tools/vocabulary_training.hpp"

namespace {

using namespace rtd;

constexpr int kRooms = 8;

struct Options {
  std::string out;
  std::vector<std::string> sources;
  int images_per_source = 20;
  double period_s = 1.0;  ///< between two images: they should differ
  slam::VocabularyTrainingOptions training;
};

std::vector<std::string> rendered_rooms() {
  std::vector<std::string> sources;
  for (int room = 1; room <= kRooms; ++room) sources.push_back(fmt::format("synthetic:tour?frames=0&seed={}", room));
  return sources;
}

std::vector<std::vector<msg::Descriptor>> describe_images(const Options& options) {
  std::vector<std::vector<msg::Descriptor>> images;
  filter::OrbExtractor extractor{filter::OrbConfig{}};
  for (const std::string& uri : options.sources) {
    const auto source = camera::make_source(uri);
    for (int i = 0; i < options.images_per_source; ++i) {
      const auto frame = source->next();
      if (!frame) break;
      images.emplace_back();
      for (const msg::Feature& feature : extractor.extract(frame->image)) images.back().push_back(feature.descriptor);
      source->pass_over(frame->image.stamp_ns + static_cast<std::int64_t>(options.period_s * 1e9));
    }
  }
  return images;
}

/// An interrupted build leaves no half vocabulary.
void write(const slam::Vocabulary& vocabulary, const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = vocabulary.serialize();
  if (bytes.size() > slam::Vocabulary::kMaxBytes) {
    throw std::runtime_error(fmt::format("{} bytes are more than 2 MB: lower --branching or --depth", bytes.size()));
  }
  io::write_file(path, io::ByteView(bytes), {.named_by = io::NamedBy::kOperator});
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Trains the vocabulary of place recognition"};
  app.add_option("out", options.out, "File to write")->required();
  app.add_option("sources", options.sources, "Image sources; none: rendered rooms");
  app.add_option("--images", options.images_per_source, "Images of each source")->check(CLI::Range(1, 100000));
  app.add_option("--period", options.period_s, "Seconds between two of them")->check(CLI::Range(0.0, 1e6));
  app.add_option("--branching", options.training.branching, "Children of a node")->check(CLI::Range(2, 64));
  app.add_option("--depth", options.training.depth, "Levels of the tree")->check(CLI::Range(1, 8));
  CLI11_PARSE(app, argc, argv);
  if (options.sources.empty()) options.sources = rendered_rooms();
  try {
    const auto images = describe_images(options);
    const slam::Vocabulary vocabulary = slam::train_vocabulary(images, options.training);
    write(vocabulary, options.out);
    fmt::print("{}: {} words from {} images\n", options.out, vocabulary.words(), images.size());
  } catch (const std::exception& error) {
    fmt::print(stderr, "rtd-train-vocabulary: {}\n", error.what());
    return 1;
  }
  return 0;
}
