// What several commands need of their arguments and output.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/box.h"
#include "victorious/store/index_store.h"

namespace victorious::cli {

/// "x,y,w,h" in pixels.
Expected<Box> ParseBox(std::string_view text);

/// "latitude,longitude,metres", degrees.
Expected<Surroundings> ParseSurroundings(std::string_view text);

/// A check for a time of a video: nothing if `text` is one, else what would be right.
std::string CheckSeconds(const std::string& text);

/// Reads `--params FILE` (JSON) into the fields; an empty path changes nothing.
Status ReadParams(const std::string& path, const std::vector<FieldRef>& fields);

/// Writes to stdout (`path` empty or "-"), or to a file, whole or not at all.
Status WriteOutput(const std::string& path, std::string_view text);

/// The text with its control characters (of a file's name, say) replaced by '?': a message stays one line.
std::string OneLine(std::string text);

/// Set by SIGINT and SIGTERM.
CancelToken& Interrupt();

/// The flags --video, --model, --from, --to and --near of commands that list what an index holds.
struct FilterArguments {
  std::string video;
  std::string model;
  std::optional<double> from_s;
  std::optional<double> to_s;
  std::string near;

  void AddTo(CLI::App& app);
  /// Errors: kInvalidArgument for times that are no numbers, or that end before they begin; for no place.
  [[nodiscard]] Expected<SightingFilter> Filter() const;
};

}  // namespace victorious::cli
