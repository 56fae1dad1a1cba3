// Shared by the tests of this folder: a short synthetic flight on disk, models of its objects, and the contents of an
// index as comparable text.
#pragma once

#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/data.h"
#include "testing/synthetic_flight.h"
#include "victorious/input/video/video_writer.h"
#include "victorious/jobs/index/indexer.h"
#include "victorious/object/model/model_library.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/show/export/export.h"
#include "victorious/show/export/export_lines.h"

namespace victorious::testing {

/// A crate and a truck, both visible more than once; small, so that rendering and searching take a second.
inline FlightOptions ShortFlight(int frames = 20) {
  FlightOptions options;
  options.seed = 5;
  options.frames = frames;
  options.width = 256;
  options.height = 192;
  options.objects = 2;
  options.object_scale = 0.6;
  options.zoom = 1.0;
  options.path_widths = 0.8;
  return options;
}

inline void WriteVideo(const SyntheticFlight& flight, const std::filesystem::path& path) {
  const FlightOptions& options = flight.options();
  auto writer = VideoWriter::Create(path, {.width = options.width, .height = options.height, .fps = options.fps});
  ASSERT_TRUE(writer) << writer.error().message;
  for (int i = 0; i < options.frames; ++i) ASSERT_TRUE((*writer)->Write(flight.Render(i).image));
  const Status finished = (*writer)->Finish();
  ASSERT_TRUE(finished) << finished.error().message;
}

/// Image of an object, masked by its alpha channel, scaled by `factor`.
inline Photo PhotoOf(const SyntheticFlight& flight, int object, double factor = 1.0) {
  cv::Mat image;
  cv::resize(flight.ObjectPhoto(object), image, {}, factor, factor, cv::INTER_AREA);
  cv::Mat bgr;
  cv::Mat alpha;
  cv::cvtColor(image, bgr, cv::COLOR_BGRA2BGR);
  cv::extractChannel(image, alpha, 3);
  return PreparePhoto(flight.ObjectName(object), bgr, alpha, std::nullopt).value();
}

/// The flight of one seed in its own folder, with its video and a library of the requested models.
class DrawnFlight {
 public:
  explicit DrawnFlight(const FlightOptions& options) : flight_(options) { WriteVideo(flight_, folder_ / "flight.mkv"); }

  [[nodiscard]] const SyntheticFlight& flight() const { return flight_; }
  [[nodiscard]] std::string video() const { return (folder_ / "flight.mkv").string(); }
  [[nodiscard]] std::filesystem::path operator/(std::string_view name) const { return folder_ / name; }

  /// Model of an object, as read back from a library, so that it has an id.
  [[nodiscard]] ObjectModel Model(int object, double factor = 1.0) const {
    const ModelLibrary library(folder_ / ("models-" + std::to_string(factor)));
    const std::string name = flight_.ObjectName(object);
    if (!library.Load(name)) {
      const Photo photo = PhotoOf(flight_, object, factor);
      EXPECT_TRUE(library.Add(MakePhotoModel(name, std::span(&photo, 1), std::nullopt, {}).value()));
    }
    return library.Load(name).value();
  }
  [[nodiscard]] std::vector<ObjectModel> Models() const { return {Model(0), Model(1)}; }

  /// Creates or opens an index in this folder.
  [[nodiscard]] std::unique_ptr<IndexStore> Store(std::string_view name) const {
    Expected<std::unique_ptr<IndexStore>> store = OpenSqliteStore(folder_ / name, StoreMode::kCreate);
    EXPECT_TRUE(store) << store.error().message;
    return *std::move(store);
  }

 private:
  ScratchFolder folder_;
  SyntheticFlight flight_;
};

inline std::vector<SightingRecord> SightingsOf(IndexStore& store, const SightingFilter& filter = {}) {
  return store.Sightings(filter).value();
}

inline std::vector<ObjectRecord> ObjectsOf(IndexStore& store, const SightingFilter& filter = {}) {
  return store.Objects(filter).value();
}

inline std::vector<VideoRecord> VideosOf(IndexStore& store) { return store.Videos().value(); }

/// All contents of an index: the exports, the searches, and the kept frames with their numbers of features.
inline std::string Contents(IndexStore& store) {
  std::ostringstream text;
  for (const ExportFormat* format : {&kObjectsFormat, &kSightingsFormat}) {
    const Status status = Export(store, *format, {}, text);
    EXPECT_TRUE(status) << status.error().message;
  }
  const std::vector<ModelRecord> models = store.Models().value();
  const std::vector<VideoRecord> videos = VideosOf(store);
  for (const VideoRecord& video : videos) {
    text << video.name << ": " << video.frame_count.value_or(-1) << " frames\n";
    for (const ModelRecord& model : models) {
      const std::optional<SearchRecord> search = store.FindSearch(video.id, model.id).value();
      text << "  " << model.name << ": ";
      if (search) text << search->next_frame << (search->finished ? " finished" : "");
      text << '\n';
    }
  }
  const Status status = store.VisitKeptFrames({}, [&](KeptFrame&& kept) {
    text << "kept " << kept.video << ' ' << kept.frame << ' ' << kept.features.size() << '\n';
    return true;
  });
  EXPECT_TRUE(status) << status.error().message;
  return text.str();
}

}  // namespace victorious::testing
