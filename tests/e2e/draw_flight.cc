// draw_flight DIR FRAMES: renders the input of the end-to-end tests. Writes a small flight to DIR/flight.mkv,
// DIR/flight.mp4 and, as a camera would send it, DIR/flight.ts, the truth of all its objects to DIR/truth.jsonl, and
// each object's photo to DIR/NAME.png.
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "testing/synthetic_flight.h"
#include "testing/video_tools.h"
#include "victorious/base/error.h"
#include "victorious/base/file.h"
#include "victorious/input/video/video_writer.h"

namespace {

namespace fs = std::filesystem;
using victorious::Status;
using victorious::VideoWriter;
using victorious::testing::FlightOptions;
using victorious::testing::SyntheticFlight;
using victorious::testing::TruthRow;

FlightOptions SmallFlight(int frames) {
  FlightOptions options;
  options.seed = 5;
  options.frames = frames;
  options.width = 256;
  options.height = 192;
  options.objects = 3;
  options.object_scale = 0.6;
  options.zoom = 1.0;
  options.path_widths = 1.2;
  return options;
}

Status WriteTruth(const SyntheticFlight& flight, const fs::path& path) {
  std::string text;
  for (int index = 0; index < flight.options().frames; ++index) {
    for (const TruthRow& row : flight.Truth(index)) {
      const nlohmann::ordered_json json = {{"frame", row.frame},
                                           {"time_s", row.time_s},
                                           {"object", row.object},
                                           {"model", row.model},
                                           {"box", {row.box.x, row.box.y, row.box.width, row.box.height}},
                                           {"visible", row.visible},
                                           {"pixels", row.pixels}};
      text += json.dump() + "\n";
    }
  }
  return victorious::WriteFileAtomically(path, text);
}

Status WritePhotos(const SyntheticFlight& flight, const fs::path& folder) {
  for (int object = 0; object < flight.options().objects; ++object) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".png", flight.ObjectPhoto(object), bytes);
    VICTORIOUS_RETURN_IF_ERROR(victorious::WriteFileAtomically(folder / (flight.ObjectName(object) + ".png"),
                                                               std::as_bytes(std::span(bytes))));
  }
  return {};
}

Status WriteVideos(const SyntheticFlight& flight, const fs::path& folder) {
  const FlightOptions& options = flight.options();
  std::vector<std::unique_ptr<VideoWriter>> writers;
  for (const char* name : {"flight.mkv", "flight.mp4"}) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        auto writer,
        VideoWriter::Create(folder / name, {.width = options.width, .height = options.height, .fps = options.fps}));
    writers.push_back(std::move(writer));
  }
  std::vector<cv::Mat> images;
  for (int index = 0; index < options.frames; ++index) {
    images.push_back(flight.Render(index).image);
    for (const auto& writer : writers) VICTORIOUS_RETURN_IF_ERROR(writer->Write(images.back()));
  }
  victorious::testing::WriteTestVideo(folder / "flight.ts", {.muxer = "mpegts",
                                                             .size = images.front().size(),
                                                             .time_base_hz = static_cast<int>(options.fps),
                                                             .pts = victorious::testing::SteadyTimes(options.frames, 1),
                                                             .images = images,
                                                             .max_b_frames = 0,
                                                             .key_frame_interval = 10});
  for (const auto& writer : writers) VICTORIOUS_RETURN_IF_ERROR(writer->Finish());
  return {};
}

Status Draw(const fs::path& folder, int frames) {
  const SyntheticFlight flight(SmallFlight(frames));
  VICTORIOUS_RETURN_IF_ERROR(WriteTruth(flight, folder / "truth.jsonl"));
  VICTORIOUS_RETURN_IF_ERROR(WritePhotos(flight, folder));
  return WriteVideos(flight, folder);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view number = argc == 3 ? argv[2] : "";
  int frames = 0;
  const auto parsed = std::from_chars(number.data(), number.data() + number.size(), frames);
  if (parsed.ec != std::errc() || frames < 1) {
    std::fprintf(stderr, "draw_flight: give a folder and the number of frames: draw_flight DIR FRAMES\n");
    return 2;
  }
  if (const Status drawn = Draw(argv[1], frames); !drawn) {
    std::fprintf(stderr, "draw_flight: %s\n", drawn.error().message.c_str());
    return 1;
  }
  return 0;
}
