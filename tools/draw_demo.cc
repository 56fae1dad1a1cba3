// draw_demo DIR: draws what `make demo` searches. A flight over a toy town in DIR/flight.mp4, with its truth in
// DIR/truth.jsonl, and photos of two of the things on the ground in DIR/photos. A third thing is there to mislead.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "testing/synthetic_flight.h"
#include "victorious/base/error.h"
#include "victorious/base/file.h"
#include "victorious/base/progress.h"
#include "victorious/video/video_writer.h"

namespace {

namespace fs = std::filesystem;
using victorious::ErrorCode;
using victorious::Fail;
using victorious::Status;
using victorious::testing::FlightOptions;
using victorious::testing::SyntheticFlight;
using victorious::testing::TruthRow;

constexpr int kSearchedThings = 2;  // the crate and the truck; what comes after them is not searched for

FlightOptions DemoFlight() {
  FlightOptions options;
  options.seed = 8;
  options.things = kSearchedThings + 1;
  options.bridge = true;
  options.perspective = 0.08;
  return options;
}

Status MakeFolder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) return std::unexpected(victorious::ErrorFromErrno(failed.value(), "make folder " + folder.string()));
  return {};
}

Status WritePhoto(const cv::Mat& picture, const fs::path& path) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", picture, bytes)) return Fail(ErrorCode::kInternal, "cannot encode " + path.string());
  return victorious::WriteFileAtomically(path, std::as_bytes(std::span(bytes)));
}

/// One line of truth.jsonl. A drawn town lies nowhere on Earth: its places are unknown.
std::string TruthLine(const TruthRow& row) {
  const nlohmann::ordered_json json = {
      {"frame", row.frame},
      {"time_s", row.time_s},
      {"object", row.object},
      {"model", row.model},
      {"box", {row.box.x, row.box.y, row.box.width, row.box.height}},
      {"visible", row.visible},
      {"pixels", row.pixels},
      {"latitude_deg", nullptr},
      {"longitude_deg", nullptr},
      {"altitude_m", nullptr},
      {"heading_deg", nullptr},
      {"view", nullptr},
  };
  return json.dump() + "\n";
}

std::string TruthText(const SyntheticFlight& flight) {
  std::string text;
  for (int index = 0; index < flight.options().frames; ++index) {
    for (const TruthRow& row : flight.Truth(index)) {
      if (row.thing < kSearchedThings) text += TruthLine(row);
    }
  }
  return text;
}

Status WriteVideo(const SyntheticFlight& flight, const fs::path& path) {
  const FlightOptions& options = flight.options();
  victorious::VideoWriterOptions video;
  video.width = options.width;
  video.height = options.height;
  video.fps = options.fps;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto writer, victorious::VideoWriter::Create(path, video));
  victorious::Progress progress("drawing " + path.string(), options.frames, "frames");
  for (int index = 0; index < options.frames; ++index) {
    VICTORIOUS_RETURN_IF_ERROR(writer->Write(flight.Render(index).image));
    progress.Update(index + 1);
  }
  return writer->Finish();
}

/// The video comes last: where it is, all is there.
Status DrawDemo(const fs::path& folder) {
  const SyntheticFlight flight(DemoFlight());
  VICTORIOUS_RETURN_IF_ERROR(MakeFolder(folder / "photos"));
  for (int thing = 0; thing < kSearchedThings; ++thing) {
    VICTORIOUS_RETURN_IF_ERROR(
        WritePhoto(flight.ThingPhoto(thing), folder / "photos" / (flight.ThingName(thing) + ".png")));
  }
  VICTORIOUS_RETURN_IF_ERROR(victorious::WriteFileAtomically(folder / "truth.jsonl", TruthText(flight)));
  return WriteVideo(flight, folder / "flight.mp4");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "draw_demo: give the folder to draw into: draw_demo DIR\n");
    return victorious::ExitStatus(ErrorCode::kInvalidArgument);
  }
  if (const Status drawn = DrawDemo(argv[1]); !drawn) {
    fmt::print(stderr, "draw_demo: {}\n", drawn.error().message);
    return victorious::ExitStatus(drawn.error().code);
  }
  return 0;
}
